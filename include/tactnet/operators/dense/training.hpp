#pragma once

#include <tactnet/kernels/batch/lane_products.hpp>
#include <tactnet/operators/dense/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t Outputs, class T, shape Input>
struct trained_layer<dense<Outputs>, T, Input> : trained_base<dense<Outputs>, T, Input> {
    using base = trained_base<dense<Outputs>, T, Input>;
    using base::inputs;
    using base::output;
    using base::weights;
    // Not by parts: totals of all weights would be too large to keep while other layers compute.

    struct memory {
        aligned_vector<double> totals; // of every thread: [output][lane]
        void resize(std::size_t) {}
    };

    static void infer(const execution_context& context, const T* values, const T*, memory&,
                      input_view<T, Input> in, output_view<T, output> out) {
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            kernels::lane_product<Outputs, inputs, kernels::matrix_layout{inputs, 1}>(
                values, in.lane_block(b), [&](std::size_t o, const kernels::vector<T>& sum) {
                    kernels::store(out.lane_block(b) + o * kernels::lanes<T>,
                                   sum + kernels::vector<T>(values[weights + o]));
                });
        });
    }

    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, output>, input_view<T, output> out_gradient,
                         output_view<T, Input> in_gradient, T* gradients) {
        kernels::sum_weight_gradients<Outputs, inputs>(
            context.threads, in.lane_blocks(), [&](std::size_t b) { return in.lane_block(b); },
            [&](std::size_t b) { return out_gradient.lane_block(b); }, gradients, gradients + weights,
            m.totals);
        if (in_gradient.data() == nullptr)
            return;
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            kernels::lane_product<inputs, Outputs, kernels::matrix_layout{1, inputs}>(
                values, out_gradient.lane_block(b), [&](std::size_t i, const kernels::vector<T>& sum) {
                    kernels::store(in_gradient.lane_block(b) + i * kernels::lanes<T>, sum);
                });
        });
    }
};

}} // namespace tactnet
