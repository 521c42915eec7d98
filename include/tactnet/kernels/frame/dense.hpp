#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/kernels/method_list.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// Dense layers of one frame or a few: a matrix times vectors, outputs side by side in vectors, one input at a
// time broadcast to all lanes.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// A dense layer over a map that lies pixel by pixel, as a compile-time description.
struct frame_dense {
    shape input;
    std::size_t input_stride; ///< elements from one pixel of the input to the next
    std::size_t outputs;

    /// Elements of the map, padded channels included.
    [[nodiscard]] constexpr std::size_t inputs() const { return input.area() * input_stride; }

    /// The widest vectors that leave the fewest lanes empty, since the time is that of reading weights.
    [[nodiscard]] constexpr std::size_t width() const {
        std::size_t best = lanes_for<float>(outputs);
        for (std::size_t w = best; w >= min_lanes<float>; w /= 2)
            if (round_up(outputs, w) < round_up(outputs, best))
                best = w;
        return best;
    }
    [[nodiscard]] constexpr std::size_t vectors() const { return ceil_div(outputs, width()); }
    [[nodiscard]] constexpr std::size_t output_stride() const { return vectors() * width(); }
    [[nodiscard]] constexpr std::size_t block_vectors() const { return std::min<std::size_t>(vectors(), 4); }
    [[nodiscard]] constexpr std::size_t weights() const { return inputs() * output_stride(); }
    /// Whether there are so many weights that reading them takes longer than the products. No network for
    /// tactile images has as many.
    [[nodiscard]] constexpr bool exceeds_near_caches() const { return outputs * input.size() >= 1'000'000; }
};

/// Partial sums of an output: one chain of additions would be bound by its latency.
template <frame_dense D, std::size_t Vectors = D.block_vectors()>
inline constexpr std::size_t dense_parts = std::max<std::size_t>(8 / Vectors, 1);

/// Frames whose sums fit the registers together, so that they share each weight that is read.
template <frame_dense D>
inline constexpr std::size_t dense_frames =
    std::max<std::size_t>(max_block_sums / (dense_parts<D> * D.block_vectors()), 1);

/// output = bias + weights · input, for frames whose inputs and outputs lie so many elements apart. The bits
/// do not depend on the number of frames.
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
                const broadcast<wide> x(input[frame * input_distance + i]);
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

/// Outputs side by side in vectors.
template <frame_dense D>
struct direct_dense_method {
    static constexpr const char* name = "direct";
    static constexpr bool applicable = true, layerwise = false;
    static constexpr std::uint64_t product_twentieths =
        std::uint64_t{D.inputs()} * D.vectors() * frame_method::product * (D.exceeds_near_caches() ? 16 : 1);
    static constexpr std::size_t output_stride = D.output_stride();
    static constexpr std::size_t packed_weights = pad_to_cache_line(D.weights());
    static constexpr std::size_t packed_elements = packed_weights + pad_to_cache_line(output_stride);
    static constexpr std::size_t workspace_elements = 0, frames_together = dense_frames<D>;

    /// Blocks of vectors of outputs, then [input][output of the block]; zeros where there is no channel or no
    /// output.
    template <class Weight>
    static constexpr void pack(const Weight& weight, const float* biases, float* to) {
        std::copy_n(biases, D.outputs, to + packed_weights);
        const auto of_input = [&](std::size_t o, std::size_t input, std::size_t, std::size_t) {
            const std::size_t channel = input % D.input_stride;
            return channel < D.input.channels ? weight(o, channel, input / D.input_stride) : 0.0f;
        };
        pack_taps(of_input, D.outputs, D.output_stride(), D.block_vectors() * D.width(), D.inputs(), 1, to);
    }
    static void run(const float* packed, const float* in, float* out, float*) noexcept {
        multiply_frames<D>(in, 0, packed, packed + packed_weights, out, 0);
    }
    /// Up to `frames_together` frames, which read each weight once.
    static void run_frames(std::size_t count, const float* packed, const float* in, std::size_t in_distance,
                           float* out, std::size_t out_distance) noexcept {
        unroll<frames_together>([&](auto i) {
            if (count == i + 1)
                multiply_frames<D, i + 1>(in, in_distance, packed, packed + packed_weights, out,
                                          out_distance);
        });
    }
};

// A matrix times the numbers of one frame, outputs side by side in vectors. The terms of each sum are added
// in the order of the inputs, then the bias: bit-identical with the lane_product of a batch.

/// A matrix for ordered products: `Rows` outputs in whole vectors, `Inputs` columns.
template <std::size_t Rows, std::size_t Inputs>
struct ordered_product {
    static constexpr std::size_t padded_rows = padded_size<float>(Rows); ///< elements of an output
    static constexpr std::size_t packed_elements = padded_rows * (Inputs + 1);

    /// Packs weight(row, input) and bias(row). Padding rows are zero.
    static constexpr void pack(const auto& weight, const auto& bias, float* packed) {
        for (std::size_t row = 0; row < padded_rows; ++row)
            packed[row] = row < Rows ? bias(row) : 0.0F;
        const auto tap = [&](std::size_t row, std::size_t input, std::size_t, std::size_t) {
            return weight(row, input);
        };
        pack_taps(tap, Rows, padded_rows, block * lanes<float>, Inputs, 1, packed + padded_rows);
    }
    /// sums[row] = Σ weights[row][input] · from[input] + bias[row]; `sums` is aligned.
    [[gnu::flatten]] static void run(const float* packed, const float* from, float* sums) noexcept {
        blocked<vectors, block>([&](auto count, std::size_t first) {
            constexpr std::size_t size = count;
            const float* weights = packed + padded_rows + first * lanes<float> * Inputs;
            std::array<vector<float>, size> sum;
#pragma GCC unroll 64
            for (std::size_t v = 0; v < size; ++v)
                sum[v] = vector<float>(0.0F);
            for (std::size_t i = 0; i < Inputs; ++i, weights += size * lanes<float>) {
                const vector<float> x(from[i]);
#pragma GCC unroll 64
                for (std::size_t v = 0; v < size; ++v)
                    sum[v] = multiply_add(load(weights + v * lanes<float>), x, sum[v]);
            }
#pragma GCC unroll 64
            for (std::size_t v = 0; v < size; ++v) {
                const std::size_t at = (first + v) * lanes<float>;
                store(sums + at, sum[v] + load(packed + at));
            }
        });
    }

private:
    static constexpr std::size_t vectors = padded_rows / lanes<float>,
                                 block = ceil_div(vectors, ceil_div(vectors, max_block_sums));
};

}}} // namespace tactnet::kernels
