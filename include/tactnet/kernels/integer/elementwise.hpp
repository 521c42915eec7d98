#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// words = nearest(counts × steps) − mean, for `Lanes` counts. A lane of the result is not zero if its count
/// is farther than `most` steps from its mean or not a number; its word is then unspecified.
template <std::size_t Lanes, class Count>
[[gnu::always_inline]] inline int32_vec<Lanes> some_counts_to_words(const Count* counts,
                                                                    const std::int16_t* mean, float steps,
                                                                    float most, std::int16_t* words) {
    const auto middle = __builtin_convertvector(load_bytes_as<int16_vec<Lanes>>(mean), int32_vec<Lanes>);
    float_vec<Lanes> scaled;
    int32_vec<Lanes> beyond{};
    if constexpr (std::is_same_v<Count, float>) {
        scaled = load_bytes_as<float_vec<Lanes>>(counts) * steps;
        const auto centre = __builtin_convertvector(middle, float_vec<Lanes>);
        // NaN fails both comparisons.
        const int32_vec<Lanes> fits = (scaled <= centre + most) & (scaled >= centre - most);
        beyond = ~fits;
        scaled = fits ? scaled : float_vec<Lanes>{};
    } else {
        const int32_vec<Lanes> whole = instructions::to_int32<Lanes>(load_bytes_as<uint8_vec<Lanes>>(counts));
        scaled = __builtin_convertvector(whole, float_vec<Lanes>) * steps;
    }
    store_any(words, __builtin_convertvector(nearest<Lanes>(scaled) - middle, int16_vec<Lanes>));
    return beyond;
}

} // namespace detail

/// Converts the counts of a frame, bytes or floats, to words of 16 bits: counts × steps − mean, rounded to
/// the nearest, ties to even. Returns whether all counts are numbers at most `most` steps from their mean;
/// counts in bytes must be.
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

/// Converts integers to bytes: √(number − zero + offset) − √offset, times a factor; a number below the zero
/// counts as the zero. Roots are rounded as IEEE 754 requires, then to 1/1024, so that the rest is exact and
/// all instruction sets give the same bytes.
template <class Number>
void roots_to_bytes(const Number* from, std::size_t count, std::int32_t zero, float offset, float factor,
                    const byte_range& range, std::uint8_t* to) noexcept {
    constexpr float parts = 1024, largest_root = 4095; // a product of both is below 2²²
    const auto whole = [&](float root) {
        return nearest<1>(float_vec<1>{(root < largest_root ? root : largest_root) * parts});
    };
    const int32_vec<1> of_zero = whole(std::sqrt(offset));
    alignas(vector_alignment) std::array<float, lanes<float>> some{};
    for (std::size_t first = 0; first < count; first += lanes<float>) {
        const std::size_t left = std::min(lanes<float>, count - first);
        for (std::size_t i = 0; i < left; ++i)
            some[i] = static_cast<float>(std::max<std::int32_t>(from[first + i] - zero, 0));
        store(some.data(), square_root<float>(load<float>(some.data()) + vector<float>(offset)));
        for (std::size_t i = 0; i < left; ++i)
            store_rounded<1>(to + first + i, whole(some[i]) - of_zero, float_vec<1>{factor}, range);
    }
}

/// The sum of two maps of bytes with different ranges: bytes times integers, exactly, and requantised.
struct byte_sum {
    /// The largest weight: both products together have 25 bits, so they convert to floats with one rounding.
    static constexpr std::int32_t most_weight = 32767;

    std::array<std::int32_t, 2> weights; ///< of a byte of each map
    std::int32_t start;                  ///< less what both zeros count
    float factor;                        ///< from sums to steps of the output
    std::int32_t zero;                   ///< of the output

    /// Adds a map to another one; both have whole cache lines.
    template <std::size_t Count>
    void add(const std::uint8_t* added, std::uint8_t* to) const noexcept {
        constexpr std::size_t width = max_integer_lanes;
        const auto load = [](const std::uint8_t* from) {
            return instructions::to_int32<width>(load_bytes_as<uint8_vec<width>>(from));
        };
        for (std::size_t e = 0; e < Count; e += width)
            store_rounded<width>(to + e, load(to + e) * weights[0] + load(added + e) * weights[1] + start,
                                 factor + float_vec<width>{}, {0, 255, zero});
    }
};

/// Resamples a frame of bytes (kernels/sampling_axis.hpp): Σ (byte − zero) · parts down · parts along, a sum
/// of integers, × 1 ÷ both denominators in single precision, rounded to the nearest integer, ties to even,
/// plus the zero. `Stride` bytes from one pixel to the next, in both maps.
template <class Down, class Along, std::size_t Stride>
void resample_bytes(const std::uint8_t* input, std::uint8_t zero, std::uint8_t* output) {
    constexpr std::size_t width = std::min(widest_bytes(Stride), max_integer_lanes);
    constexpr std::size_t parts = Down::denominator * Along::denominator;
    static_assert(parts <= std::size_t{1} << 23, "resample_bytes: sums must fit into 32 bits");
    constexpr float share = 1 / static_cast<float>(parts);
    const float_vec<width> factors = share - float_vec<width>{};
    const int32_vec<width> start = int32_vec<width>{} - static_cast<std::int32_t>(parts) * zero;
    const byte_range range{0, 255, zero};
    for (const auto& above : Down::table)
        for (const auto& beside : Along::table) {
            const std::uint8_t* const from = input + (above.first * Along::inputs + beside.first) * Stride;
            for (std::size_t channel = 0; channel < Stride; channel += width) {
                int32_vec<width> sum = start;
                for (std::size_t y = 0; y < Down::taps; ++y)
                    for (std::size_t x = 0; x < Along::taps; ++x)
                        sum += instructions::to_int32<width>(load_bytes_as<uint8_vec<width>>(
                                   from + (y * Along::inputs + x) * Stride + channel)) *
                               (above.parts[y] * beside.parts[x]);
                store_rounded<width>(output + channel, sum, factors, range);
            }
            output += Stride;
        }
}

}}} // namespace tactnet::kernels
