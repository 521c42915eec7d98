#pragma once

#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/operators/gate/layer.hpp>
#include <tactnet/operators/sequence/training.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <class... Branch, class T, shape Input>
struct trained_layer<gate<Branch...>, T, Input> : trained_base<gate<Branch...>, T, Input> {
    using base = trained_base<gate<Branch...>, T, Input>;
    using base::output;
    using branch = trained_layer<sequence<Branch...>, T, Input>;

    struct memory {
        typename branch::memory branch_memory;
        aligned_vector<T> factors, factor_gradients;
        void resize(std::size_t samples) {
            branch_memory.resize(samples);
            detail::grow(factors, kernels::padded_size<T>(samples) * branch::output.size());
        }
    };
    static void prepare(const execution_context& context, const T* values, const T* running, memory& m) {
        branch::prepare(context, values, running, m.branch_memory);
    }
    static void infer(const execution_context& context, const T* values, const T* running, memory& m,
                      input_view<T, Input> in, output_view<T, output> out) {
        run<false>(context, values, running, m, in, out);
    }
    static void forward(const execution_context& context, const T* values, T* running, memory& m,
                        input_view<T, Input> in, output_view<T, output> out) {
        run<true>(context, values, running, m, in, out);
    }
    /// By the product rule: the branch sets the gradient of the input, to which its factors times the
    /// gradient of the output are added.
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, output>, input_view<T, output> out_gradient,
                         output_view<T, Input> in_gradient, T* gradients) {
        const factor_view factors(m.factors.data(), in.samples());
        detail::grow(m.factor_gradients, m.factors.size());
        const output_view<T, branch::output> factor_gradients(m.factor_gradients.data(), in.samples());
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            kernels::multiply_channels_backward(Input.channels, Input.area(), in.lane_block(b),
                                                out_gradient.lane_block(b), factor_gradients.lane_block(b));
        });
        branch::backward(context, values, m.branch_memory, in, factors,
                         factor_view(factor_gradients.data(), in.samples()), in_gradient, gradients);
        if (in_gradient.data() != nullptr)
            context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
                kernels::add_multiplied_channels(Input.channels, Input.area(), out_gradient.lane_block(b),
                                                 factors.lane_block(b), in_gradient.lane_block(b));
            });
    }

private:
    using factor_view = input_view<T, branch::output>;

    template <bool Training, class Statistic>
    static void run(const execution_context& context, const T* values, Statistic* running, memory& m,
                    input_view<T, Input> in, output_view<T, output> out) {
        const output_view<T, branch::output> factors(m.factors.data(), in.samples());
        detail::run<Training, branch>(context, values, running, m.branch_memory, in, factors);
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            kernels::multiply_channels(Input.channels, Input.area(), in.lane_block(b), factors.lane_block(b),
                                       out.lane_block(b));
        });
    }
};

}} // namespace tactnet
