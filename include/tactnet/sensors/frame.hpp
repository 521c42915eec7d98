#pragma once

#include <tactnet/tensor/shape.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

// The common form of all sensors and file formats: frames of rows × columns cells, each with a number and, if
// known, a time, and one description of their source.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The unit of cells: raw counts of the converter, or pressure.
enum class pressure_unit : std::uint8_t { raw, pascal };

/// The source of frames. Unknown values are empty.
struct recording_description {
    std::string format{};  ///< for example "Tekscan ASCII"
    std::string version{}; ///< of the program or device
    std::size_t rows = 0, columns = 0;
    std::optional<double> row_spacing{};    ///< metres between the centres of neighbouring rows
    std::optional<double> column_spacing{}; ///< metres between the centres of neighbouring columns
    std::optional<double> cell_area{};      ///< square metres
    pressure_unit unit = pressure_unit::raw;
    std::optional<double> full_scale{};          ///< the largest count
    std::optional<double> saturation_pressure{}; ///< pascal at the largest count
    std::optional<double> noise_threshold{};     ///< counts
    std::optional<double> seconds_per_frame{};
    std::optional<std::uint64_t> frames{}; ///< number announced by the source
    /// One entry per cell, row by row: 1 if there is a tactel, else 0. Empty: all cells have one.
    std::vector<std::uint8_t> mask{};
    /// The keys and values of a text header, without the quotes and separators that spreadsheets add.
    std::vector<std::pair<std::string, std::string>> header{};

    [[nodiscard]] std::size_t cells() const noexcept { return rows * columns; }
    [[nodiscard]] bool exists(std::size_t cell) const noexcept { return mask.empty() || mask[cell] != 0; }
    [[nodiscard]] std::size_t missing_cells() const noexcept {
        return static_cast<std::size_t>(std::count(mask.begin(), mask.end(), std::uint8_t{0}));
    }
};

/// A view of a frame, for example of a decoder until its next call. Cells without a tactel are zero.
struct frame_view {
    std::uint64_t number = 0;      ///< as in the source, else counted from 1
    std::optional<double> seconds; ///< since the start of the source
    std::size_t rows = 0, columns = 0;
    std::span<const float> cells; ///< rows × columns, row by row; NaN: broken, only in described formats
    bool certain = true;          ///< false if later bytes may show that the frame is not whole

    [[nodiscard]] float operator()(std::size_t row, std::size_t column) const {
        return cells[row * columns + column];
    }

    /// Returns the frame as a view of a shape known at compile time; nothing if it has another size.
    template <shape Shape>
    [[nodiscard]] std::optional<tensor_view<const float, Shape>> as() const noexcept {
        static_assert(Shape.channels == 1, "frame_view: a frame has one channel");
        if (rows != Shape.rows || columns != Shape.columns || cells.size() != Shape.size())
            return std::nullopt;
        return tensor_view<const float, Shape>(cells.data());
    }

    /// Returns the 8-bit counts that networks are trained on; nothing if the frame has another size or a cell
    /// is not an integer from 0 to 255.
    template <shape Shape>
    [[nodiscard]] std::optional<tensor<std::uint8_t, Shape>> counts() const noexcept {
        const auto whole = as<Shape>();
        if (!whole)
            return std::nullopt;
        std::optional<tensor<std::uint8_t, Shape>> result(std::in_place);
        for (std::size_t i = 0; i < Shape.size(); ++i) {
            if (!(cells[i] >= 0 && cells[i] <= 255) || cells[i] != std::floor(cells[i]))
                return std::nullopt;
            result->data()[i] = static_cast<std::uint8_t>(cells[i]);
        }
        return result;
    }
};

}} // namespace tactnet
