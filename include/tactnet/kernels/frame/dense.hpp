#pragma once

#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Matrix times vectors for one frame or a few, for deployed networks: outputs side by side in vectors, one
// input at a time spread over all lanes.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// A dense layer behind a map that lies pixel by pixel.
struct frame_dense {
    shape input;
    std::size_t input_stride; ///< elements from one pixel of the input to the next
    std::size_t outputs;

    /// Elements of the map, padded channels included.
    [[nodiscard]] constexpr std::size_t inputs() const { return input.area() * input_stride; }

    /// The widest vectors that leave the fewest lanes empty: what counts are the weights read from memory.
    [[nodiscard]] constexpr std::size_t width() const {
        std::size_t best = lanes_for<float>(outputs);
        for (std::size_t w = best; w >= min_lanes<float>; w /= 2)
            if ((outputs + w - 1) / w * w < (outputs + best - 1) / best * best)
                best = w;
        return best;
    }
    [[nodiscard]] constexpr std::size_t vectors() const { return (outputs + width() - 1) / width(); }
    [[nodiscard]] constexpr std::size_t output_stride() const { return vectors() * width(); }
    [[nodiscard]] constexpr std::size_t block_vectors() const { return std::min<std::size_t>(vectors(), 4); }
    [[nodiscard]] constexpr std::size_t weights() const { return inputs() * output_stride(); }
};

/// Weights in the order of use: blocks of vectors of outputs, then [input][output of the block]; zeros where
/// there is no channel or no output. `weight(output, channel, pixel)`.
template <frame_dense D, class Weight>
constexpr void pack_dense_weights(float* packed, Weight&& weight) {
    const std::size_t block = D.block_vectors() * D.width();
    for (std::size_t first = 0; first < D.output_stride(); first += block)
        for (std::size_t input = 0; input < D.inputs(); ++input)
            for (std::size_t o = first; o < std::min(first + block, D.output_stride()); ++o)
                *packed++ = o < D.outputs && input % D.input_stride < D.input.channels
                                ? weight(o, input % D.input_stride, input / D.input_stride)
                                : 0.0f;
}

/// Partial sums of an output, since one chain of additions would wait for each of them.
template <frame_dense D, std::size_t Vectors = D.block_vectors()>
inline constexpr std::size_t dense_parts = std::max<std::size_t>(8 / Vectors, 1);

/// Frames whose sums fit the registers, so that they share each weight that is read.
template <frame_dense D>
inline constexpr std::size_t
    dense_frames = std::max<std::size_t>(max_block_sums / (dense_parts<D> * D.block_vectors()), 1);

/// output = bias + weights · input, for frames whose inputs and outputs lie so many elements apart; the bits
/// do not depend on their number.
template <frame_dense D, std::size_t Frames = 1>
[[gnu::flatten]] void multiply_frames(const float* input, std::size_t input_distance, const float* weights,
                                      const float* bias, float* output, std::size_t output_distance) {
    constexpr std::size_t width = D.width();
    using wide = sized_vector<float, width>;
    constexpr std::size_t inputs = D.inputs();
    blocked<D.vectors(), D.block_vectors()>([&](auto block, std::size_t first) {
        constexpr std::size_t vectors = block, parts = dense_parts<D, vectors>;
        constexpr std::size_t lines = Frames * parts, sums_of_block = lines * vectors;
        register_block<wide, lines, vectors> sums;
#pragma GCC unroll 64
        for (std::size_t i = 0; i < sums_of_block; ++i)
            sums[i / vectors][i % vectors] = wide(0.0f);
        const float* const w = weights + first * width * inputs;
        const auto add = [&](std::size_t part, std::size_t i) __attribute__((always_inline)) {
            std::array<wide, vectors> of_input;
#pragma GCC unroll 64
            for (std::size_t v = 0; v < vectors; ++v)
                of_input[v] = load_as<wide>(w + (i * vectors + v) * width);
#pragma GCC unroll 64
            for (std::size_t frame = 0; frame < Frames; ++frame) {
                const wide x(input[frame * input_distance + i]);
#pragma GCC unroll 64
                for (std::size_t v = 0; v < vectors; ++v)
                    sums[frame * parts + part][v] =
                        fused_multiply_add(of_input[v], x, sums[frame * parts + part][v]);
            }
        };
        for (std::size_t i = 0; i + parts <= inputs; i += parts) {
#pragma GCC unroll 64
            for (std::size_t p = 0; p < parts; ++p)
                add(p, i + p);
        }
#pragma GCC unroll 64
        for (std::size_t i = inputs / parts * parts; i < inputs; ++i)
            add(i % parts, i);
#pragma GCC unroll 64
        for (std::size_t frame = 0; frame < Frames; ++frame)
#pragma GCC unroll 64
            for (std::size_t v = 0; v < vectors; ++v) {
                wide sum = load_as<wide>(bias + (first + v) * width);
#pragma GCC unroll 64
                for (std::size_t p = 0; p < parts; ++p)
                    sum = sum + sums[frame * parts + p][v];
                store_as(output + frame * output_distance + (first + v) * width, sum);
            }
    });
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
