#pragma once

#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/operators/residual/layer.hpp>
#include <tactnet/operators/sequence/training.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <class Main, class Skip, class T, shape Input>
struct trained_layer<residual<Main, Skip>, T, Input> : trained_base<residual<Main, Skip>, T, Input> {
    using base = trained_base<residual<Main, Skip>, T, Input>;
    using base::output;
    using base::projects;
    using main = trained_layer<as_sequence<Main>, T, Input>;
    using skip = trained_layer<as_sequence<Skip>, T, Input>;

    struct memory {
        typename main::memory main_memory;
        typename skip::memory skip_memory;
        aligned_vector<T> skip_output, skip_gradient, main_output;
        void resize(std::size_t samples) {
            main_memory.resize(samples);
            skip_memory.resize(samples);
            const std::size_t places = kernels::padded_size<T>(samples);
            if constexpr (main::keeps_output)
                main_output.resize(places * output.size());
            if constexpr (projects) {
                skip_output.resize(places * output.size());
                skip_gradient.resize(places * Input.size());
            }
        }
    };
    static void prepare(const execution_context& context, const T* values, const T* running, memory& m) {
        main::prepare(context, values, running, m.main_memory);
        skip::prepare(context, values + main::parameters, running + main::statistics, m.skip_memory);
    }
    static void infer(const execution_context& context, const T* values, const T* running, memory& m,
                      input_view<T, Input> in, output_view<T, output> out) {
        run<false>(context, values, running, m, in, out);
    }
    static void forward(const execution_context& context, const T* values, T* running, memory& m,
                        input_view<T, Input> in, output_view<T, output> out) {
        run<true>(context, values, running, m, in, out);
    }
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, output> out,
                         input_view<T, output> out_gradient, output_view<T, Input> in_gradient,
                         T* gradients) {
        main::backward(context, values, m.main_memory, in,
                       main::keeps_output ? input_view<T, output>(m.main_output.data(), in.samples()) : out,
                       out_gradient, in_gradient, gradients);
        const T* skip_gradient = out_gradient.data();
        if constexpr (projects) {
            T* to = in_gradient.data() ? m.skip_gradient.data() : nullptr;
            skip::backward(context.of_skip(), values + main::parameters, m.skip_memory, in,
                           {m.skip_output.data(), in.samples()}, out_gradient, {to, in.samples()},
                           gradients + main::parameters);
            skip_gradient = to;
        }
        if (in_gradient.data() != nullptr)
            sum<Input>(context, in_gradient, {skip_gradient, in.samples()}, in_gradient);
    }

private:
    template <bool Training, class Statistic>
    static void run(const execution_context& context, const T* values, Statistic* running, memory& m,
                    input_view<T, Input> in, output_view<T, output> out) {
        // The sum can take the place of the main branch's output unless the backward pass needs that.
        output_view<T, output> main_out = out;
        if constexpr (main::keeps_output)
            main_out = {m.main_output.data(), out.samples()};
        detail::run<Training, main>(context, values, running, m.main_memory, in, main_out);
        if constexpr (projects) {
            const output_view<T, output> skip_out(m.skip_output.data(), in.samples());
            detail::run<Training, skip>(context.of_skip(), values + main::parameters,
                                        running + main::statistics, m.skip_memory, in, skip_out);
            sum<output>(context, main_out, skip_out, out);
        } else {
            sum<output>(context, main_out, {in.data(), in.samples()}, out);
        }
    }
    template <shape Shape>
    static void sum(const execution_context& context, input_view<T, Shape> a, input_view<T, Shape> b,
                    output_view<T, Shape> to) {
        context.threads.for_each(to.lane_blocks(), [&](std::size_t i) {
            kernels::add(a.lane_block(i), b.lane_block(i), to.lane_block(i), to.lane_block_size);
        });
    }
};

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
