#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/frame/tactels.hpp>
#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// A frame of counts, row after row, with zeros before and after it: kernels read around each tactel. Counts
/// are of 8 bits, or 1/256 of these in 16.
template <shape Array, class Count = std::uint8_t>
struct padded_frame {
    static_assert(Array.channels == 1, "padded_frame: an array of tactels has one channel");
    /// The tactels, in whole vectors.
    static constexpr std::size_t span = kernels::whole_count_vectors(Array.size());
    static constexpr std::size_t first = round_up(Array.columns + 1, vector_alignment);

    alignas(vector_alignment) std::array<Count, first + span + Array.columns + 1> counts{};

    [[nodiscard]] Count* tactels() noexcept { return counts.data() + first; }
    [[nodiscard]] const Count* tactels() const noexcept { return counts.data() + first; }
};

/// The mean of some neighbours of a tactel, in place of its own count.
template <shape Array, class Count = std::uint8_t>
class neighbour_mean {
    static constexpr Count all = static_cast<Count>(-1);

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
            mask_[n] = all;
            ++count;
        }
        reciprocal_ = static_cast<std::uint16_t>(count > 0 ? (0xFFFFU + count / 2) / count : 0);
    }

    [[nodiscard]] std::size_t place() const noexcept { return place_; }
    /// The rounded mean; 0 if there is no neighbour.
    [[nodiscard]] Count of(const padded_frame<Array, Count>& frame) const noexcept {
        const Count* const own = frame.tactels() + place_;
        std::conditional_t<sizeof(Count) == 1, std::uint32_t, std::uint64_t> sum = 0;
        for (std::size_t n = 0; n < 8; ++n)
            sum += static_cast<std::uint32_t>(own[kernels::neighbour_distances<Array.columns>[n]] & mask_[n]);
        return static_cast<Count>((sum * reciprocal_ + 0x8000U) >> 16U);
    }

private:
    static_assert(Array.size() <= 0x10000, "neighbour_mean: at most 65536 tactels");
    std::uint16_t place_ = 0, reciprocal_ = 0;
    std::array<Count, 8> mask_{}; ///< all bits for a neighbour that counts, else 0
};

}}} // namespace tactnet::detail
