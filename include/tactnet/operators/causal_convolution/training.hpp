#pragma once

#include <tactnet/kernels/batch/lane_products.hpp>
#include <tactnet/operators/causal_convolution/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <algorithm>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t Filters, std::size_t Taps, std::size_t Dilation, class T, shape Input>
struct trained_layer<causal_conv1d<Filters, Taps, Dilation>, T, Input>
    : trained_base<causal_conv1d<Filters, Taps, Dilation>, T, Input> {
    using base = trained_base<causal_conv1d<Filters, Taps, Dilation>, T, Input>;
    using base::biases;
    using base::features;
    using base::frames;
    using base::inputs;
    using base::output;
    /// For each lane block: the inputs of an output, in training of each frame, and gradients.
    struct memory {
        aligned_vector<T> inputs, gradients;
        aligned_vector<double> totals;
        void resize(std::size_t samples) { detail::grow(inputs, lane_blocks_of<T>(samples) * input_size); }
    };

    static void infer(const execution_context& context, const T* values, const T*, memory& m,
                      input_view<T, Input> in, output_view<T, output> out) {
        compute(context, values, m, 1, in, out);
    }
    static void forward(const execution_context& context, const T* values, T*, memory& m,
                        input_view<T, Input> in, output_view<T, output> out) {
        detail::grow(m.inputs, in.lane_blocks() * frames * input_size);
        compute(context, values, m, frames, in, out);
    }
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, output>, input_view<T, output> out_gradient,
                         output_view<T, Input> in_gradient, T* gradients) {
        const std::size_t blocks = in.lane_blocks();
        detail::grow(m.gradients, blocks * frames * output_size);
        context.threads.for_each(blocks, [&](std::size_t b) {
            T* const to = in_gradient.data() ? in_gradient.lane_block(b) : nullptr;
            if (to)
                std::fill_n(to, in_gradient.lane_block_size, T{});
            for (std::size_t frame = 0; frame < frames; ++frame) {
                T* const of_outputs = m.gradients.data() + (b * frames + frame) * output_size;
                detail::read_frame<output>(out_gradient.lane_block(b), frame, of_outputs);
                if (to)
                    add_input_gradients(values, of_outputs, frame, to);
            }
        });
        kernels::sum_weight_gradients<Filters, inputs>(
            context.threads, blocks * frames, [&](std::size_t i) { return m.inputs.data() + i * input_size; },
            [&](std::size_t i) { return m.gradients.data() + i * output_size; }, gradients,
            gradients + biases, m.totals);
    }

private:
    static constexpr std::size_t lanes = kernels::lanes<T>, input_size = inputs * lanes,
                                 output_size = Filters * lanes;

    /// Keeps the inputs of `kept` frames of each lane block.
    static void compute(const execution_context& context, const T* values, memory& m, std::size_t kept,
                        input_view<T, Input> in, output_view<T, output> out) {
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            for (std::size_t frame = 0; frame < frames; ++frame) {
                T* const x = m.inputs.data() + (b * kept + frame % kept) * input_size;
                gather(in.lane_block(b), frame, x);
                kernels::lane_product<Filters, inputs, kernels::matrix_layout{inputs, 1}>(
                    values, x, [&](std::size_t o, const kernels::vector<T>& sum) {
                        kernels::store(out.lane_block(b) + (o * frames + frame) * lanes,
                                       sum + kernels::vector<T>(values[biases + o]));
                    });
            }
        });
    }
    /// Calls body(index of feature and tap, frame) for all inputs of a frame's output. A frame from
    /// `frames` on lies before the first.
    static void for_each_input(std::size_t frame, const auto& body) {
        for (std::size_t feature = 0; feature < features; ++feature)
            for (std::size_t tap = 0; tap < Taps; ++tap)
                body(feature * Taps + tap, feature, frame - (Taps - 1 - tap) * Dilation);
    }
    static void gather(const T* in, std::size_t frame, T* to) {
        for_each_input(frame, [&](std::size_t i, std::size_t feature, std::size_t from) {
            kernels::store(to + i * lanes, from < frames
                                               ? kernels::load(in + (feature * frames + from) * lanes)
                                               : kernels::vector<T>(T{}));
        });
    }
    static void add_input_gradients(const T* values, const T* of_outputs, std::size_t frame, T* to) {
        kernels::lane_product<inputs, Filters, kernels::matrix_layout{1, inputs}>(
            values, of_outputs, [&](std::size_t i, const kernels::vector<T>& sum) {
                const std::size_t from = frame - (Taps - 1 - i % Taps) * Dilation;
                if (from < frames) {
                    T* const at = to + (i / Taps * frames + from) * lanes;
                    kernels::store(at, kernels::load(at) + sum);
                }
            });
    }
};

}} // namespace tactnet
