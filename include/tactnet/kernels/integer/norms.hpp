#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/norms.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ratio>

// Group, instance and layer norms of bytes. The sum of n bytes q and the sum of their squares are exact
// integers, and so is n² times their variance, D = n · Σq² − (Σq)². A byte normalises to (n · q − Σq) ÷
// √(D + margin), where the margin is n² · epsilon in steps of the map. This number is multiplied by the
// weight of its channel, rounded to 1/256 of a step of the output, and the bias is added as an integer. No
// rounded product is added to anything in floating point, so all instruction sets give the same bytes.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// A norm of bytes as compile-time constants.
struct byte_norm {
    std::size_t pixels, channels;
    std::size_t stride;              ///< elements from one pixel to the next
    std::size_t groups = 1;          ///< groups of channels, each with moments of its own
    bool weight_per_element = false; ///< weights are [pixel][stride] instead of [stride]

    /// Outputs are computed in parts of a step.
    static constexpr float parts = 256;
    /// The largest magnitude of a product with a weight, and of a bias, in parts.
    static constexpr float most_parts = 0x1p21f;
    /// The most bytes in a group: their number times a byte fits 31 bits.
    static constexpr std::size_t most_bytes = std::size_t{1} << 23;
};

/// What a norm is applied with, all of them packed: floats and integers of 32 bits for each channel, or for
/// each element of the map.
struct byte_norm_parameters {
    const std::int8_t* weights; ///< in parts of a step of the output
    const std::int8_t* biases;  ///< integers, in parts
    float margin;
    byte_range range;
};

namespace detail {

/// Σq and 1 ÷ √(D + margin) of some bytes.
struct byte_moments {
    std::int32_t sum;
    float factor;

    byte_moments(std::size_t count, std::uint64_t total, std::uint64_t squares, float margin)
        : sum(static_cast<std::int32_t>(total)),
          factor(1 /
                 std::sqrt(static_cast<float>(static_cast<std::int64_t>(count * squares - total * total)) +
                           margin)) {}
};

/// Sums of the bytes in each lane, and of their squares.
template <std::size_t Lanes>
struct lane_sums {
    int32_vec<Lanes> totals{}, squares{};
    /// The sum of so many squares fits 31 bits.
    static constexpr std::size_t most = std::size_t{1} << 15;

    [[gnu::always_inline]] void add(const std::uint8_t* from) {
        const int32_vec<Lanes> bytes = instructions::to_int32<Lanes>(load_bytes_as<uint8_vec<Lanes>>(from));
        totals += bytes, squares += bytes * bytes;
    }
};

/// Normalises `Lanes` bytes, of `count` bytes with these sums and factors.
template <std::size_t Lanes>
[[gnu::always_inline]] inline void normalise_some(const std::uint8_t* in, std::int32_t count,
                                                  const int32_vec<Lanes>& sums,
                                                  const float_vec<Lanes>& factors, std::size_t parameter,
                                                  const byte_norm_parameters& by, std::uint8_t* out) {
    const int32_vec<Lanes> distances =
        instructions::to_int32<Lanes>(load_bytes_as<uint8_vec<Lanes>>(in)) * count - sums;
    const std::size_t at = parameter * sizeof(float);
    float_vec<Lanes> scaled = __builtin_convertvector(distances, float_vec<Lanes>) * factors *
                              load_bytes_as<float_vec<Lanes>>(by.weights + at);
    const float_vec<Lanes> most = byte_norm::most_parts + float_vec<Lanes>{};
    scaled = scaled < most ? scaled : most;
    scaled = scaled > -most ? scaled : -most;
    store_rounded<Lanes>(out, nearest<Lanes>(scaled) + load_bytes_as<int32_vec<Lanes>>(by.biases + at),
                         1 / byte_norm::parts + float_vec<Lanes>{}, by.range);
}

template <byte_norm N>
inline constexpr std::size_t norm_lanes = std::min(widest_bytes(N.stride), max_integer_lanes);

} // namespace detail

/// Normalises groups of channels. `memory` has memory_bytes and begins at a cache line.
template <byte_norm N>
class byte_group_norm {
    static constexpr std::size_t in_group = N.channels / N.groups, count = in_group * N.pixels;
    static_assert(count <= byte_norm::most_bytes,
                  "sample_norm_step: in 8 bits a norm takes at most 2^23 numbers together");
    // Three arrays: sums of each channel, later of its group; factors; squares.
    static constexpr std::size_t sums_bytes =
        pad_to_cache_line<std::uint8_t>(N.stride * sizeof(std::uint32_t));

public:
    static constexpr std::size_t memory_bytes =
        2 * sums_bytes + pad_to_cache_line<std::uint8_t>(N.stride * sizeof(std::uint64_t));

    static void run(const byte_norm_parameters& by, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        auto* const sums = reinterpret_cast<std::int32_t*>(memory);
        auto* const factors = reinterpret_cast<float*>(memory + sums_bytes);
        auto* const squares = reinterpret_cast<std::uint64_t*>(memory + 2 * sums_bytes);
        std::fill_n(sums, N.stride, 0);
        std::fill_n(factors, N.stride, 0.0f); // also of lanes after the last channel
        std::fill_n(squares, N.stride, std::uint64_t{});
        constexpr std::size_t width = detail::norm_lanes<N>;
        for (std::size_t c = 0; c < N.stride; c += width)
            for (std::size_t first = 0; first < N.pixels; first += detail::lane_sums<width>::most) {
                detail::lane_sums<width> some;
                const std::size_t end = std::min(first + some.most, N.pixels);
                for (std::size_t pixel = first; pixel < end; ++pixel)
                    some.add(in + pixel * N.stride + c);
                for (std::size_t lane = 0; lane < width; ++lane) {
                    sums[c + lane] += some.totals[lane];
                    squares[c + lane] += static_cast<std::uint64_t>(some.squares[lane]);
                }
            }
        for (std::size_t first = 0; first < N.channels; first += in_group) {
            std::uint64_t total = 0, of_squares = 0;
            for (std::size_t c = first; c < first + in_group; ++c)
                total += static_cast<std::uint64_t>(sums[c]), of_squares += squares[c];
            const detail::byte_moments moments(count, total, of_squares, by.margin);
            std::fill_n(sums + first, in_group, moments.sum);
            std::fill_n(factors + first, in_group, moments.factor);
        }
        for (std::size_t pixel = 0; pixel < N.pixels; ++pixel)
            for (std::size_t c = 0; c < N.stride; c += width) {
                const std::size_t e = pixel * N.stride + c;
                detail::normalise_some<width>(
                    in + e, static_cast<std::int32_t>(count), load_bytes_as<int32_vec<width>>(sums + c),
                    load_bytes_as<float_vec<width>>(factors + c), N.weight_per_element ? e : c, by, out + e);
            }
    }
};

/// Normalises the channels of each pixel.
template <byte_norm N>
class byte_pixel_norm {
    static constexpr std::size_t width = detail::norm_lanes<N>, most = detail::lane_sums<width>::most;
    static_assert(N.channels <= most,
                  "sample_norm_step: in 8 bits a norm takes at most 32768 channels of a pixel together");

public:
    static constexpr std::size_t memory_bytes = 0;

    static void run(const byte_norm_parameters& by, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t*) noexcept {
        for (std::size_t e = 0; e < N.pixels * N.stride; e += N.stride) {
            constexpr std::size_t whole = N.channels / width * width;
            detail::lane_sums<width> some;
            for (std::size_t c = 0; c < whole; c += width)
                some.add(in + e + c);
            std::uint64_t total = 0, squares = 0;
            const auto add = [&](std::int32_t of_bytes, std::int32_t of_squares) {
                total += static_cast<std::uint64_t>(of_bytes);
                squares += static_cast<std::uint64_t>(of_squares);
            };
            for (std::size_t lane = 0; lane < width; ++lane)
                add(some.totals[lane], some.squares[lane]);
            for (std::size_t c = whole; c < N.channels; ++c)
                add(in[e + c], in[e + c] * in[e + c]);
            const detail::byte_moments moments(N.channels, total, squares, by.margin);
            for (std::size_t c = 0; c < N.stride; c += width)
                detail::normalise_some<width>(in + e + c, static_cast<std::int32_t>(N.channels),
                                              moments.sum + int32_vec<width>{},
                                              moments.factor + float_vec<width>{}, c, by, out + e + c);
        }
    }
};

// Local response normalisation of bytes. The sum of squares S of the bytes less their zero is an exact
// integer. With the margin m = k ÷ (α/n · step²), the divisor (k + α/n · Σ x²)^β is k^β · ((S + m) ÷ m)^β.
// Roots, products and quotients are rounded one by one as IEEE 754 requires, and no product is added to
// anything: all instruction sets give the same bytes.

/// The exponents of a local response normalisation that square roots compute.
template <class Beta>
concept exponent_of_roots =
    std::ratio_equal_v<Beta, std::ratio<1, 2>> || std::ratio_equal_v<Beta, std::ratio<3, 4>> ||
    std::ratio_equal_v<Beta, std::ratio<1>>;

/// The numbers with which responses in bytes are normalised.
struct byte_response_constants {
    float margin;         ///< m
    float ratio;          ///< steps of the output in a step of the input
    std::int32_t zero;    ///< of the input
    std::int32_t to_zero; ///< of the output
};

/// Normalises the channels of each pixel, `Stride` elements from one pixel to the next in both maps.
template <class Rule, std::size_t Channels, std::size_t Stride>
void normalise_byte_responses(std::size_t pixels, const byte_response_constants& constants,
                              const std::uint8_t* in, std::uint8_t* out) noexcept {
    static_assert(Rule::size * 255 * 255 <= 1 << 24); // single precision holds such sums of squares
    constexpr std::size_t width = std::min(widest_bytes(Stride), max_integer_lanes),
                          room = padded_size<float>(Stride);
    const auto power = [](float x) {
        alignas(vector_alignment) std::array<float, lanes<float>> all;
        store(all.data(), Rule::template power<float>(vector<float>(x)));
        return all[0];
    };
    const float factor = constants.ratio * (power(static_cast<float>(Rule::k)) / power(constants.margin));
    const byte_range range{0, 255, constants.to_zero};
    std::array<std::int32_t, Stride + Rule::size> squares{};
    alignas(vector_alignment) std::array<float, room> powers;
    powers.fill(1);
    for (std::size_t p = 0; p < pixels; ++p, in += Stride, out += Stride) {
        for (std::size_t c = 0; c < Channels; ++c) {
            const std::int32_t distance = in[c] - constants.zero;
            squares[Rule::before + c] = distance * distance;
        }
        for (std::size_t c = 0; c < Stride; c += width) {
            int32_vec<width> sum{};
            for (std::size_t i = 0; i < Rule::size; ++i)
                sum += load_bytes_as<int32_vec<width>>(squares.data() + c + i);
            store_any(powers.data() + c, __builtin_convertvector(sum, float_vec<width>) + constants.margin);
        }
        for (std::size_t c = 0; c < room; c += lanes<float>)
            store(powers.data() + c, Rule::template power<float>(load(powers.data() + c)));
        for (std::size_t c = 0; c < Stride; c += width) {
            const int32_vec<width> distances =
                instructions::to_int32<width>(load_bytes_as<uint8_vec<width>>(in + c)) - constants.zero;
            const float_vec<width> factors = load_bytes_as<float_vec<width>>(powers.data() + c) * factor;
            store_rounded<width>(out + c, distances, factors, range);
        }
    }
}

}}} // namespace tactnet::kernels
