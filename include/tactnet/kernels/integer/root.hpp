#pragma once

#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/alignment.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// From whole numbers to bytes: √(number − zero + offset) − √offset, times a factor; of a number below the
/// zero, that of the zero. Roots are rounded as IEEE 754 says, then to 1/1024, so that all that follows is
/// whole: the same bytes with every instruction set.
template <class Number>
void roots_to_bytes(const Number* from, std::size_t count, std::int32_t zero, float offset, float factor,
                    const byte_range& range, std::uint8_t* to) noexcept {
    constexpr float parts = 1024, largest_root = 4095; // a product of both is below 2²²
    const auto whole = [&](float root) {
        return nearest<1>(float_vec<1>{(root < largest_root ? root : largest_root) * parts});
    };
    const int32_vec<1> of_zero = whole(std::sqrt(offset));
    alignas(alignment) std::array<float, lanes<float>> some{};
    for (std::size_t first = 0; first < count; first += lanes<float>) {
        const std::size_t left = std::min(lanes<float>, count - first);
        for (std::size_t i = 0; i < left; ++i)
            some[i] = static_cast<float>(std::max<std::int32_t>(from[first + i] - zero, 0));
        store(some.data(), square_root<float>(load<float>(some.data()) + vector<float>(offset)));
        for (std::size_t i = 0; i < left; ++i)
            store_rounded<1>(to + first + i, whole(some[i]) - of_zero, float_vec<1>{factor}, range);
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
