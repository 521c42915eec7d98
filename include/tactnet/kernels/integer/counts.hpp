#pragma once

#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/integer/vector.hpp>

#include <cstddef>
#include <cstdint>
#include <type_traits>

// Where a frame comes in: from counts to words of 16 bits.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

namespace detail {

/// words = nearest(counts × steps) − mean, for `Lanes` counts. Lanes of the result are zero but for counts
/// farther than `most` steps from their mean, and for those that are no number; what they give is any word.
template <std::size_t Lanes, class Count>
[[gnu::always_inline]] inline int32_vec<Lanes> some_counts_to_words(const Count* counts,
                                                                    const std::int16_t* mean, float steps,
                                                                    float most, std::int16_t* words) {
    const auto middle = __builtin_convertvector(load_any<int16_vec<Lanes>>(mean), int32_vec<Lanes>);
    float_vec<Lanes> scaled;
    int32_vec<Lanes> beyond{};
    if constexpr (std::is_same_v<Count, float>) {
        scaled = load_any<float_vec<Lanes>>(counts) * steps;
        const auto centre = __builtin_convertvector(middle, float_vec<Lanes>);
        // Comparisons that NaN fails.
        const int32_vec<Lanes> fits = (scaled <= centre + most) & (scaled >= centre - most);
        beyond = ~fits;
        scaled = fits ? scaled : float_vec<Lanes>{};
    } else {
        const int32_vec<Lanes> whole = to_int32<Lanes>(load_any<uint8_vec<Lanes>>(counts));
        scaled = __builtin_convertvector(whole, float_vec<Lanes>) * steps;
    }
    store_any(words, __builtin_convertvector(nearest<Lanes>(scaled) - middle, int16_vec<Lanes>));
    return beyond;
}

} // namespace detail

/// words = counts × steps − mean for `count` counts in bytes or floats, rounded to the nearest, ties to the
/// even one. Whether all are numbers at most `most` steps from their mean, as counts in bytes must be.
template <class Count>
[[nodiscard]] inline bool counts_to_words(const Count* counts, std::size_t count, const std::int16_t* mean,
                                          float steps, float most, std::int16_t* words) {
    constexpr std::size_t width = max_integer_lanes;
    const std::size_t in_vectors = count / width * width;
    int32_vec<width> beyond{};
    for (std::size_t at = 0; at < in_vectors; at += width)
        beyond |= detail::some_counts_to_words<width>(counts + at, mean + at, steps, most, words + at);
    std::int32_t any = 0;
    for (std::size_t at = in_vectors; at < count; ++at)
        any |= detail::some_counts_to_words<1>(counts + at, mean + at, steps, most, words + at)[0];
    for (std::size_t lane = 0; lane < width; ++lane)
        any |= beyond[lane];
    return any == 0;
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
