#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/special_functions.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// The largest of some values, and whether all are finite. −infinity of none.
template <class T>
struct value_range {
    T largest = -std::numeric_limits<T>::infinity();
    bool finite = true;

    explicit value_range(std::span<const T> values) noexcept {
        for (const T value : values) {
            finite &= std::abs(value) <= std::numeric_limits<T>::max();
            largest = value > largest ? value : largest;
        }
    }
};

/// The sum of e^((value − largest) · scale), for values of which none is larger. Powers are in single
/// precision, with an error of at most 2⁻¹⁷ of themselves, 2⁻²² from e⁻² on; those below e⁻⁸⁷ count as 0.
template <class T>
[[nodiscard]] double sum_of_exponentials(std::span<const T> values, T largest, double scale) noexcept {
    constexpr std::size_t block = 64, ways = 4; // sums of their own, which need not wait for one another
    static_assert(block % kernels::lanes<float> == 0);
    alignas(vector_alignment) std::array<float, block> powers;
    std::array<double, ways> sums{};
    for (std::size_t first = 0; first < values.size(); first += block) {
        const std::size_t count = std::min(block, values.size() - first);
        for (std::size_t i = 0; i < count; ++i)
            powers[i] = static_cast<float>(
                (static_cast<double>(values[first + i]) - static_cast<double>(largest)) * scale);
        const std::size_t padded =
            ceil_div(count, std::max(kernels::lanes<float>, ways)) * std::max(kernels::lanes<float>, ways);
        std::fill(powers.begin() + static_cast<std::ptrdiff_t>(count),
                  powers.begin() + static_cast<std::ptrdiff_t>(padded),
                  -std::numeric_limits<float>::infinity());
        for (std::size_t i = 0; i < padded; i += kernels::lanes<float>)
            kernels::store(powers.data() + i, kernels::exponential(kernels::load(powers.data() + i)));
        for (std::size_t i = 0; i < padded; i += ways)
            for (std::size_t way = 0; way < ways; ++way)
                sums[way] += static_cast<double>(powers[i + way]);
    }
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

}}} // namespace tactnet::detail
