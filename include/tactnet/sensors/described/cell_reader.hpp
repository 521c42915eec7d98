#pragma once

#include <tactnet/sensors/described/description.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

// From the cells as a device sends them to a frame: values become counts, in the order of the frame.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The place in the frame, counted row by row, of each cell in the order in which a device sends them.
[[nodiscard]] inline std::vector<std::uint32_t> cell_places(const sensor_description& d) {
    const std::size_t halves_of_rows = d.blocks == block_order::stacked ? 2 : 1;
    const std::size_t halves_of_columns = d.blocks == block_order::side_by_side ? 2 : 1;
    const std::size_t block_rows = d.rows / halves_of_rows, block_columns = d.columns / halves_of_columns;
    const std::size_t line = d.order == cell_order::rows ? block_columns : block_rows;
    std::vector<std::uint32_t> places(d.cells());
    for (std::size_t i = 0; i < places.size(); ++i) {
        const std::size_t block = i / (block_rows * block_columns),
                          in_block = i % (block_rows * block_columns);
        std::size_t row = in_block / line, column = in_block % line;
        if (d.serpentine && row % 2 == 1)
            column = line - 1 - column;
        if (d.order == cell_order::columns)
            std::swap(row, column);
        row += halves_of_rows == 2 ? block * block_rows : 0;
        column += halves_of_columns == 2 ? block * block_columns : 0;
        std::size_t rows = d.rows, columns = d.columns;
        if (d.transposed)
            std::swap(row, column), std::swap(rows, columns);
        if (d.flipped_rows)
            row = rows - 1 - row;
        if (d.flipped_columns)
            column = columns - 1 - column;
        for (unsigned turned = 0; turned < d.rotation; turned += 90) {
            row = std::exchange(column, rows - 1 - row);
            std::swap(rows, columns);
        }
        places[i] = static_cast<std::uint32_t>(row * columns + column);
    }
    return places;
}

/// Reads the cells of an array. Integers of up to 16 bits without values for broken cells are fastest.
class cell_reader {
public:
    /// Throws std::invalid_argument for a description that cannot be.
    explicit cell_reader(const sensor_description& d)
        : offset_(d.offset),
          sign_(d.inverted ? -1 : 1),
          above_(d.broken_above.value_or(std::numeric_limits<double>::infinity())),
          clamps_(d.negative_is_zero || d.inverted || d.offset != 0),
          nan_is_broken_(
              std::any_of(d.broken.begin(), d.broken.end(), [](double b) { return std::isnan(b); })),
          cells_(d.cells()),
          read_(reader_of(d)) {
        require_valid(d);
        std::copy_if(d.broken.begin(), d.broken.end(), std::back_inserter(broken_),
                     [](double b) { return !std::isnan(b); });
        checks_ = !broken_.empty() || d.broken_above;
        places_ = cell_places(d);
        bool in_order = true;
        for (std::size_t i = 0; i < places_.size(); ++i)
            in_order = in_order && places_[i] == i;
        if (in_order)
            places_ = {};
        else
            sent_.resize(cells_);
    }

    /// Reads the cells of a packet into a frame of as many cells. Returns the place in the frame of the first
    /// that is no count; the number of cells if all are.
    std::size_t read(const std::byte* from, std::span<float> frame) {
        const std::size_t good = (this->*read_)(from, sent(frame).data());
        if (good < cells_)
            return place(good);
        arrange(frame);
        return cells_;
    }

    /// The place in the frame of the cell that a device sends as number `i`, from 0.
    [[nodiscard]] std::size_t place(std::size_t i) const noexcept { return places_.empty() ? i : places_[i]; }

    /// Where to put counts in the order in which the device sends them, before `arrange`.
    [[nodiscard]] std::span<float> sent(std::span<float> frame) noexcept {
        return places_.empty() ? frame : std::span<float>(sent_);
    }
    /// Puts the counts of `sent` in the order of the frame.
    void arrange(std::span<float> frame) const noexcept {
        for (std::size_t i = 0; i < places_.size(); ++i)
            frame[places_[i]] = sent_[i];
    }

    /// The count of a value, NaN for a broken cell. Returns false if it is none.
    [[nodiscard]] bool count(double value, float& to) const noexcept {
        constexpr auto largest = static_cast<double>(std::numeric_limits<float>::max());
        const double count = sign_ * (value - offset_);
        if (!checks_ && count >= 0 && count <= largest) {
            to = static_cast<float>(count) + 0.0F; // no -0
            return true;
        }
        if (value > above_ || std::find(broken_.begin(), broken_.end(), value) != broken_.end() ||
            (std::isnan(value) && nan_is_broken_)) {
            to = std::numeric_limits<float>::quiet_NaN();
            return true;
        }
        if (!(count <= largest) || (count < 0 && (!clamps_ || std::isinf(value))))
            return false;
        to = static_cast<float>(count < 0 ? 0 : count) + 0.0F;
        return true;
    }

private:
    using reader = std::size_t (cell_reader::*)(const std::byte*, float*) const;

    static reader reader_of(const sensor_description& d) noexcept {
        return d.cell == cell_type::digits
                   ? nullptr
                   : reader_among<std::uint8_t, std::int8_t, std::uint16_t, std::int16_t, std::uint32_t,
                                  std::int32_t, std::uint64_t, std::int64_t, float, double>(d);
    }
    /// `Cells` are as in cell_type.
    template <class... Cells>
    static reader reader_among(const sensor_description& d) noexcept {
        constexpr std::array<reader, 2 * sizeof...(Cells)> readers{&cell_reader::read_as<Cells, false>...,
                                                                   &cell_reader::read_as<Cells, true>...};
        const bool swap =
            (d.cell_bytes == byte_order::little) != (std::endian::native == std::endian::little);
        return readers[static_cast<std::size_t>(d.cell) + (swap ? sizeof...(Cells) : 0)];
    }

    template <class Cell, bool Swap>
    static Cell load(const std::byte* from, std::size_t i) noexcept {
        using word = std::conditional_t<sizeof(Cell) == 4, std::uint32_t, std::uint64_t>;
        using bits = std::conditional_t<sizeof(Cell) == 1, std::uint8_t,
                                        std::conditional_t<sizeof(Cell) == 2, std::uint16_t, word>>;
        bits value;
        std::memcpy(&value, from + i * sizeof(Cell), sizeof(Cell));
        return detail::bits_as<Cell>(Swap ? detail::byte_swapped(value) : value);
    }

    template <class Cell, bool Swap>
    std::size_t read_as(const std::byte* from, float* to) const {
        if (checks_ || std::is_floating_point_v<Cell>)
            return read_checked<Cell, Swap>(from, to);
        // Exact in single precision up to 16 bits.
        using exact = std::conditional_t<sizeof(Cell) <= 2, float, double>;
        const auto sign = static_cast<exact>(sign_), offset = static_cast<exact>(offset_);
        const std::size_t cells = cells_;
        if (std::is_unsigned_v<Cell> && sign_ == 1 && offset_ == 0) {
            for (std::size_t i = 0; i < cells; ++i)
                to[i] = static_cast<float>(load<Cell, Swap>(from, i));
            return cells;
        }
        bool negative = false;
        for (std::size_t i = 0; i < cells; ++i) {
            const exact count = sign * (static_cast<exact>(load<Cell, Swap>(from, i)) - offset);
            negative |= count < 0;
            to[i] = static_cast<float>(count < 0 ? exact{0} : count) + 0.0F; // no -0
        }
        return negative && !clamps_ ? read_checked<Cell, Swap>(from, to) : cells;
    }
    template <class Cell, bool Swap>
    std::size_t read_checked(const std::byte* from, float* to) const {
        for (std::size_t i = 0; i < cells_; ++i)
            if (!count(static_cast<double>(load<Cell, Swap>(from, i)), to[i]))
                return i;
        return cells_;
    }

    double offset_, sign_, above_;
    bool clamps_, nan_is_broken_, checks_ = false;
    std::size_t cells_;
    reader read_;
    std::vector<double> broken_;
    std::vector<std::uint32_t> places_; ///< empty: in order
    std::vector<float> sent_;
};

}} // namespace tactnet
