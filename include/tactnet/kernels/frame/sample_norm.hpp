#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/frame/elementwise.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>

// Group, instance and layer norms of one frame that lies pixel by pixel. In single precision, so that small
// processors need no double for each element: from a rough mean of a group, in a second pass the distances
// from it and their squares, in a third the norm. Runs of distances are added plainly, and the runs with
// their rounding errors kept, so that the error does not grow with the frame.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// A map and its norm. In weights and biases, lanes after the last channel hold zeros.
struct frame_norm {
    std::size_t pixels, channels, stride; ///< `stride` elements from one pixel to the next
    std::size_t groups = 1;               ///< of channels, each normalised over all pixels
    bool weight_per_element = false;      ///< [pixel][stride], otherwise [stride]
    bool rectified = false;               ///< with a ReLU after it
};

/// Adds x to a sum, and the rounding error to the rest (Knuth's TwoSum).
template <class Vector>
[[gnu::always_inline]] inline void add_exactly(const Vector& x, float* to, float* to_rest) {
    using access = pixel_access<Vector>;
    const Vector sum = access::load(to), total = sum + x, added = total - sum;
    access::store(to_rest, access::load(to_rest) + ((sum - (total - added)) + (x - added)));
    access::store(to, total);
}

/// What a group norm keeps of each channel while it runs, in arrays of `room` elements. `scale` and `shift`
/// bring x − center to the norm, before weight and bias.
struct group_norm_memory {
    static constexpr std::size_t arrays = 7;
    float *center, *scale, *shift, *sums, *sums_rest, *squares, *squares_rest;

    group_norm_memory(float* memory, std::size_t room)
        : center(memory),
          scale(center + room),
          shift(scale + room),
          sums(shift + room),
          sums_rest(sums + room),
          squares(sums_rest + room),
          squares_rest(squares + room) {}
};

/// Sets the sums of x − center over all pixels for each lane of a pixel, and with `Squares` those of the
/// squares. This second pass runs backwards, since the cache still holds the end of the map.
template <bool Squares, class Vector>
void sum_deviations(const frame_norm& norm, const float* in, const group_norm_memory& memory) {
    // Chains of plain sums do not wait for each other: at most 16 roundings in a run, with those of the
    // chains.
    constexpr std::size_t width = sizeof(Vector) / sizeof(float), chains = 4, plain_terms = 12 * chains;
    using access = pixel_access<Vector>;
    std::fill_n(memory.sums, norm.stride, 0.0F), std::fill_n(memory.sums_rest, norm.stride, 0.0F);
    std::fill_n(memory.squares, norm.stride, 0.0F), std::fill_n(memory.squares_rest, norm.stride, 0.0F);
    const std::size_t runs = ceil_div(norm.pixels, plain_terms);
    for (std::size_t i = 0; i < runs; ++i) {
        const std::size_t first = (Squares ? runs - 1 - i : i) * plain_terms,
                          end = std::min(first + plain_terms, norm.pixels);
        for (std::size_t v = 0; v < norm.stride; v += width) {
            const Vector center = access::load(memory.center + v);
            std::array<Vector, chains> run, run_squares;
            run.fill(Vector(0.0F)), run_squares.fill(Vector(0.0F));
            const auto add = [&](std::size_t chain, std::size_t p) __attribute__((always_inline)) {
                const Vector d = access::load(in + p * norm.stride + v) - center;
                run[chain] = run[chain] + d;
                run_squares[chain] = fused_multiply_add(d, d, run_squares[chain]);
            };
            std::size_t p = first;
            for (; p + chains <= end; p += chains)
#pragma GCC unroll 4
                for (std::size_t chain = 0; chain < chains; ++chain)
                    add(chain, p + chain);
            for (; p < end; ++p)
                add(0, p);
            add_exactly((run[0] + run[1]) + (run[2] + run[3]), memory.sums + v, memory.sums_rest + v);
            if constexpr (Squares)
                add_exactly((run_squares[0] + run_squares[1]) + (run_squares[2] + run_squares[3]),
                            memory.squares + v, memory.squares_rest + v);
        }
    }
}

/// max(y, 0) if the norm is rectified; NaN stays NaN.
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector rectified(const frame_norm& norm, const Vector& y) {
    return norm.rectified ? pixel_access<Vector>::larger(Vector(0.0F), y) : y;
}

/// Group, instance and layer norm: each group of channels over all pixels. `Vector` divides the stride.
template <class Vector>
void normalise_channel_groups(const frame_norm& norm, const float* weights, const float* biases,
                              float epsilon, const float* in, float* out, const group_norm_memory& memory) {
    constexpr std::size_t width = sizeof(Vector) / sizeof(float);
    using access = pixel_access<Vector>;
    const std::size_t of_group = norm.channels / norm.groups;
    const double count = static_cast<double>(of_group * norm.pixels);
    const auto mean_of = [&](const float* sums, const float* rests, std::size_t first) {
        std::array<double, 4> chains{};
        for (std::size_t c = 0; c < of_group; ++c)
            chains[c % 4] += static_cast<double>(sums[first + c]) + static_cast<double>(rests[first + c]);
        return ((chains[0] + chains[1]) + (chains[2] + chains[3])) / count;
    };
    // A rough mean, from the first value of each group.
    std::fill_n(memory.center, norm.stride, 0.0F);
    for (std::size_t first = 0; first < norm.channels; first += of_group)
        std::fill_n(memory.center + first, of_group, in[first]);
    sum_deviations<false, Vector>(norm, in, memory);
    for (std::size_t first = 0; first < norm.channels; first += of_group)
        std::fill_n(memory.center + first, of_group,
                    static_cast<float>(static_cast<double>(memory.center[first]) +
                                       mean_of(memory.sums, memory.sums_rest, first)));
    sum_deviations<true, Vector>(norm, in, memory);
    std::fill_n(memory.scale, norm.stride, 0.0F);
    std::fill_n(memory.shift, norm.stride, 0.0F);
    for (std::size_t first = 0; first < norm.channels; first += of_group) {
        const double rest = mean_of(memory.sums, memory.sums_rest, first),
                     squares = mean_of(memory.squares, memory.squares_rest, first),
                     inverse = 1 / std::sqrt(std::max(fused_multiply_add(-rest, rest, squares), 0.0) +
                                             static_cast<double>(epsilon));
        std::fill_n(memory.scale + first, of_group, static_cast<float>(inverse));
        std::fill_n(memory.shift + first, of_group, static_cast<float>(-rest * inverse));
    }
    for (std::size_t v = 0; v < norm.stride; v += width) {
        const Vector center = access::load(memory.center + v), scale = access::load(memory.scale + v),
                     shift = access::load(memory.shift + v);
        for (std::size_t e = v; e < norm.pixels * norm.stride; e += norm.stride) {
            const std::size_t w = norm.weight_per_element ? e : v;
            const Vector normalised = fused_multiply_add(access::load(in + e) - center, scale, shift);
            const Vector weight = access::load(weights + w), bias = access::load(biases + w);
            access::store(out + e, rectified(norm, fused_multiply_add(normalised, weight, bias)));
        }
    }
}

/// The sum of the lanes, half by half. In registers: narrow loads of what was stored wide wait for it.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline float sum_halves(const float_vec<Lanes>& values) {
    if constexpr (Lanes == 4) {
        const float_vec<4> pairs = values + __builtin_shufflevector(values, values, 2, 3, 2, 3);
        return pairs[0] + pairs[1];
    } else {
        return [&]<int... I>(std::integer_sequence<int, I...>) __attribute__((always_inline)) {
            constexpr int half = static_cast<int>(Lanes / 2);
            return sum_halves<Lanes / 2>(__builtin_shufflevector(values, values, I...) +
                                         __builtin_shufflevector(values, values, (half + I)...));
        }
        (std::make_integer_sequence<int, static_cast<int>(Lanes / 2)>{});
    }
}
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline float sum_of_lanes(const Vector& values) {
    constexpr std::size_t width = sizeof(Vector) / sizeof(float);
    if constexpr (width == 1) {
        float sum;
        pixel_access<Vector>::store(&sum, values);
        return sum;
    } else {
        return sum_halves<width>(load_bytes_as<float_vec<width>>(&values));
    }
}

/// Layer norm over the channels of each of `Together` pixels, side by side, so that none waits for the sums
/// of another. `last` holds zeros after the last channel, otherwise ones.
template <std::size_t Together, class Vector>
void normalise_pixels(const frame_norm& norm, const float* weights, const float* biases, float epsilon,
                      const Vector& last, const float* in, float* out) {
    constexpr std::size_t width = sizeof(Vector) / sizeof(float);
    using access = pixel_access<Vector>;
    const float share = 1 / static_cast<float>(norm.channels);
    std::array<Vector, Together> center, sum, squares, scale, shift;
    // body(pixel, x − center) for vectors of channels, with zeros after the last.
    const auto for_each_deviation = [&](const auto& body) {
        for (std::size_t v = 0; v < norm.channels; v += width)
            for (std::size_t p = 0; p < Together; ++p) {
                const Vector d = access::load(in + p * norm.stride + v) - center[p];
                body(p, v + width > norm.channels ? d * last : d);
            }
    };
    for (std::size_t p = 0; p < Together; ++p)
        center[p] = Vector(in[p * norm.stride]), sum[p] = Vector(0.0F);
    for_each_deviation([&](std::size_t p, const Vector& d) { sum[p] = sum[p] + d; });
    for (std::size_t p = 0; p < Together; ++p) {
        center[p] = Vector(fused_multiply_add(sum_of_lanes(sum[p]), share, in[p * norm.stride]));
        sum[p] = squares[p] = Vector(0.0F);
    }
    for_each_deviation([&](std::size_t p, const Vector& d) {
        sum[p] = sum[p] + d;
        squares[p] = fused_multiply_add(d, d, squares[p]);
    });
    // Sums of lanes in a loop of their own, so that the compiler computes the rest for all pixels at once.
    std::array<float, Together> means, mean_squares;
    for (std::size_t p = 0; p < Together; ++p)
        means[p] = sum_of_lanes(sum[p]), mean_squares[p] = sum_of_lanes(squares[p]);
    std::array<float, Together> inverses, shifts;
    for (std::size_t p = 0; p < Together; ++p) {
        means[p] *= share, mean_squares[p] *= share;
        const float variance = std::max(fused_multiply_add(-means[p], means[p], mean_squares[p]), 0.0F);
        inverses[p] = 1 / std::sqrt(variance + epsilon), shifts[p] = -means[p] * inverses[p];
    }
    for (std::size_t p = 0; p < Together; ++p)
        scale[p] = Vector(inverses[p]), shift[p] = Vector(shifts[p]);
    for (std::size_t v = 0; v < norm.stride; v += width) {
        const Vector weight = access::load(weights + v), bias = access::load(biases + v);
        for (std::size_t p = 0; p < Together; ++p) {
            const std::size_t at = p * norm.stride + v;
            const Vector normalised =
                fused_multiply_add(access::load(in + at) - center[p], scale[p], shift[p]);
            access::store(out + at, rectified(norm, fused_multiply_add(normalised, weight, bias)));
        }
    }
}

/// Layer norm over the channels of each pixel. `Vector` divides the stride.
template <class Vector>
void normalise_each_pixel(const frame_norm& norm, const float* weights, const float* biases, float epsilon,
                          const float* in, float* out) {
    // The center, the sum and the squares of each pixel stay in registers.
    constexpr std::size_t width = sizeof(Vector) / sizeof(float), together = max_block_sums / 3;
    alignas(vector_alignment) std::array<float, width> in_use{};
    std::fill_n(in_use.begin(), (norm.channels - 1) % width + 1, 1.0F);
    const Vector last = pixel_access<Vector>::load(in_use.data());
    std::size_t p = 0;
    for (; p + together <= norm.pixels; p += together)
        normalise_pixels<together>(norm, weights, biases, epsilon, last, in + p * norm.stride,
                                   out + p * norm.stride);
    for (; p < norm.pixels; ++p)
        normalise_pixels<1>(norm, weights, biases, epsilon, last, in + p * norm.stride,
                            out + p * norm.stride);
}

}}} // namespace tactnet::kernels
