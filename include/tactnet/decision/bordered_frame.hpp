#pragma once

#include <tactnet/kernels/frame/tactels.hpp>
#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// A frame of counts with a border of zeros, so that each tactel has eight neighbours.
template <shape Array>
struct bordered_frame {
    static_assert(Array.channels == 1, "bordered_frame: an array of tactels has one channel");
    static constexpr std::size_t stride = Array.columns + 2;
    /// Tactels and the borders between their rows, from the first tactel on, in whole vectors.
    static constexpr std::size_t span = kernels::whole_count_vectors(Array.rows * stride);
    /// The place of the first tactel, and of any.
    static constexpr std::size_t first = stride + 1;
    [[nodiscard]] static constexpr std::size_t place(std::size_t row, std::size_t column) noexcept {
        return first + row * stride + column;
    }
    static constexpr auto& neighbours = kernels::neighbour_distances<stride>;

    std::array<std::uint8_t, span + 2 * stride + 2> counts{};
};

/// The mean of some neighbours of a tactel, in place of its own count.
template <shape Array>
class neighbour_mean {
    using grid = bordered_frame<Array>;

public:
    neighbour_mean() = default;
    /// Leaves out neighbours beyond the array and those with `left_out(row, column)`.
    template <class LeftOut>
    neighbour_mean(std::size_t row, std::size_t column, const LeftOut& left_out) noexcept
        : place_(static_cast<std::uint16_t>(grid::place(row, column))) {
        std::uint32_t count = 0;
        for (std::size_t n = 0; n < 8; ++n) {
            // From 1, since the first neighbour is above and to the left.
            const std::size_t y = row + grid::neighbours[n] / grid::stride,
                              x = column + grid::neighbours[n] % grid::stride;
            if (y < 1 || x < 1 || y > Array.rows || x > Array.columns || left_out(y - 1, x - 1))
                continue;
            mask_[n] = 255;
            ++count;
        }
        reciprocal_ = static_cast<std::uint16_t>(count > 0 ? (0xFFFFU + count / 2) / count : 0);
    }

    [[nodiscard]] std::size_t place() const noexcept { return place_; }
    /// The rounded mean; 0 if there is no neighbour.
    [[nodiscard]] std::uint8_t of(const grid& frame) const noexcept {
        const std::uint8_t* const around = frame.counts.data() + place_ - grid::first;
        std::uint32_t sum = 0;
        for (std::size_t n = 0; n < 8; ++n)
            sum += static_cast<std::uint32_t>(around[grid::neighbours[n]] & mask_[n]);
        return static_cast<std::uint8_t>((sum * reciprocal_ + 0x8000U) >> 16U);
    }

private:
    static_assert(grid::place(Array.rows, 0) <= 0xFFFF, "neighbour_mean: at most 65535 tactels");
    std::uint16_t place_ = 0, reciprocal_ = 0;
    std::array<std::uint8_t, 8> mask_{}; ///< 255 for a neighbour that counts, else 0
};

}}} // namespace tactnet::detail
