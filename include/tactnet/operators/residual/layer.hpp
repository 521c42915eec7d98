#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/operators/sequence/layer.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t MainRows, std::size_t MainColumns, std::size_t MainChannels, std::size_t SkipRows,
          std::size_t SkipColumns, std::size_t SkipChannels>
concept branches_agree =
    (MainRows == SkipRows) && (MainColumns == SkipColumns) && (MainChannels == SkipChannels);

namespace detail {

template <std::size_t MainRows, std::size_t MainColumns, std::size_t MainChannels, std::size_t SkipRows,
          std::size_t SkipColumns, std::size_t SkipChannels>
[[nodiscard]] constexpr shape residual_output() {
    static_assert(
        branches_agree<MainRows, MainColumns, MainChannels, SkipRows, SkipColumns, SkipChannels>,
        "residual: both branches must give the same shape; branches_agree shows rows, columns and channels "
        "of the main branch, then those of the skip");
    return {MainRows, MainColumns, MainChannels};
}

/// The costs of the sum of two branches. A projection needs memory of its own.
[[nodiscard]] constexpr layer_costs costs_of_sum(const layer_costs& main, const layer_costs& skip,
                                                 bool projects) {
    const std::size_t map = main.output.size();
    layer_costs sum{.output = main.output,
                    .inner_activations =
                        (main.keeps_output ? map : 0) +
                        std::max(main.inner_activations, projects ? map + skip.inner_activations : 0)};
    sum.add(main);
    sum.add(skip);
    return sum;
}

} // namespace detail

/// The skip of a residual block without a projection.
using identity_layer = sequence<>;

/// Residual block (He, Zhang, Ren, Sun, 2016): main(x) + skip(x), where skip is `identity_layer` or a
/// projection. A branch is a list of layers or a single one. The ReLU after the sum is a layer of its own.
/// The arrays of the skip begin with "projection", or with the name that it is given.
template <class Main, class Skip = identity_layer>
struct residual {
    static constexpr std::string_view name = "block";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return detail::costs_of_sum(as_sequence<Main>::costs(input), as_sequence<Skip>::costs(input),
                                    as_sequence<Skip>::size > 0);
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, residual> {
        using main = typename as_sequence<Main>::template layer<T, Input>;
        using skip = typename as_sequence<Skip>::template layer<T, Input>;
        static constexpr shape output =
            detail::residual_output<main::output.rows, main::output.columns, main::output.channels,
                                    skip::output.rows, skip::output.columns, skip::output.channels>();
        static constexpr bool projects = as_sequence<Skip>::size > 0;

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

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            main::describe(prefix, list);
            detail::describe_inner(skip::describe, joined_name(prefix, std::string(skip_name)),
                                   {.parameters = main::parameters, .statistics = main::statistics}, list);
        }
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
                           main::keeps_output ? input_view<T, output>(m.main_output.data(), in.samples())
                                              : out,
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
        static constexpr std::string_view skip_name = [] {
            if constexpr (detail::has_given_name<Skip>)
                return Skip::name;
            else
                return std::string_view("projection");
        }();

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
};

}} // namespace tactnet
