#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/frame/tactels.hpp>
#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// A frame of counts, row after row, with zeros before and after it: kernels read around each tactel.
template <shape Array>
struct padded_frame {
    static_assert(Array.channels == 1, "padded_frame: an array of tactels has one channel");
    /// The tactels, in whole vectors.
    static constexpr std::size_t span = kernels::whole_count_vectors(Array.size());
    static constexpr std::size_t first = round_up(Array.columns + 1, vector_alignment);

    alignas(vector_alignment) std::array<std::uint8_t, first + span + Array.columns + 1> counts{};

    [[nodiscard]] std::uint8_t* tactels() noexcept { return counts.data() + first; }
    [[nodiscard]] const std::uint8_t* tactels() const noexcept { return counts.data() + first; }
};

/// The mean of some neighbours of a tactel, in place of its own count.
template <shape Array>
class neighbour_mean {
public:
    neighbour_mean() = default;
    /// Leaves out neighbours beyond the array and those with `left_out(place)`.
    template <class LeftOut>
    neighbour_mean(std::size_t place, const LeftOut& left_out) noexcept
        : place_(static_cast<std::uint16_t>(place)) {
        std::uint32_t count = 0;
        for (std::size_t n = 0; n < 8; ++n) {
            const std::size_t neighbour = kernels::neighbour_place<Array.rows, Array.columns>(place, n);
            if (neighbour >= Array.size() || left_out(neighbour))
                continue;
            mask_[n] = 255;
            ++count;
        }
        reciprocal_ = static_cast<std::uint16_t>(count > 0 ? (0xFFFFU + count / 2) / count : 0);
    }

    [[nodiscard]] std::size_t place() const noexcept { return place_; }
    /// The rounded mean; 0 if there is no neighbour.
    [[nodiscard]] std::uint8_t of(const padded_frame<Array>& frame) const noexcept {
        const std::uint8_t* const own = frame.tactels() + place_;
        std::uint32_t sum = 0;
        for (std::size_t n = 0; n < 8; ++n)
            sum += static_cast<std::uint32_t>(own[kernels::neighbour_distances<Array.columns>[n]] & mask_[n]);
        return static_cast<std::uint8_t>((sum * reciprocal_ + 0x8000U) >> 16U);
    }

private:
    static_assert(Array.size() <= 0x10000, "neighbour_mean: at most 65536 tactels");
    std::uint16_t place_ = 0, reciprocal_ = 0;
    std::array<std::uint8_t, 8> mask_{}; ///< 255 for a neighbour that counts, else 0
};

}}} // namespace tactnet::detail
