#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/layers/composition/sequence.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <std::size_t MainRows, std::size_t MainColumns, std::size_t MainChannels, std::size_t SkipRows,
          std::size_t SkipColumns, std::size_t SkipChannels>
concept branches_agree = (MainRows == SkipRows) && (MainColumns == SkipColumns) &&
                         (MainChannels == SkipChannels);

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

/// Of the sum of two branches; a skip that is a projection has memory of its own.
[[nodiscard]] constexpr layer_costs costs_of_sum(const layer_costs& main, const layer_costs& skip,
                                                 bool projects) {
    const std::size_t map = main.output.size();
    return {.output = main.output,
            .parameters = main.parameters + skip.parameters,
            .statistics = main.statistics + skip.statistics,
            .multiply_adds = main.multiply_adds + skip.multiply_adds,
            .multiply_adds_on_pixels = main.multiply_adds_on_pixels + skip.multiply_adds_on_pixels,
            .inner_activations =
                (main.keeps_output ? map : 0) +
                std::max(main.inner_activations, projects ? map + skip.inner_activations : 0)};
}

} // namespace detail

/// The skip of a residual block that passes its input on as it is.
using identity_layer = sequence<>;

/// Residual block (He, Zhang, Ren, Sun, 2016): main(x) + skip(x), where skip is `identity` or a projection.
/// A branch is a list of layers or a single one. The ReLU behind the sum is a layer of its own. The arrays of
/// the skip go by "projection", or by the name that it is given.
template <class Main, class Skip = identity_layer>
struct residual {
    static constexpr std::string_view name = "block";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return detail::costs_of_sum(as_sequence<Main>::costs(input), as_sequence<Skip>::costs(input),
                                    as_sequence<Skip>::size > 0);
    }

    template <class T, shape Input>
    struct layer {
        using value_type = T;
        using main = typename as_sequence<Main>::template layer<T, Input>;
        using skip = typename as_sequence<Skip>::template layer<T, Input>;
        static constexpr shape input = Input;
        static constexpr shape output =
            detail::residual_output<main::output.rows, main::output.columns, main::output.channels,
                                    skip::output.rows, skip::output.columns, skip::output.channels>();

    private:
        static constexpr layer_costs all =
            detail::costs_of_sum(costs_of_layer<main>, costs_of_layer<skip>, as_sequence<Skip>::size > 0);

    public:
        static constexpr std::size_t parameters = all.parameters, statistics = all.statistics;
        static constexpr std::size_t multiply_adds = all.multiply_adds,
                                     multiply_adds_on_pixels = all.multiply_adds_on_pixels;
        static constexpr std::size_t inner_activations = all.inner_activations;
        static constexpr bool projects = as_sequence<Skip>::size > 0;
        static constexpr bool in_place = false, keeps_output = false;
        static constexpr bool by_parts = false, observes = false; // has stages of its own

        struct memory {
            typename main::memory main_memory;
            typename skip::memory skip_memory;
            aligned_vector<T> skip_output, skip_gradient, main_output;
            void resize(std::size_t samples) {
                main_memory.resize(samples);
                skip_memory.resize(samples);
                const std::size_t groups = groups_of<T>(samples);
                if constexpr (main::keeps_output)
                    main_output.resize(groups * kernels::lanes<T> * output.size());
                if constexpr (projects) {
                    skip_output.resize(groups * kernels::lanes<T> * output.size());
                    skip_gradient.resize(groups * kernels::lanes<T> * Input.size());
                }
            }
        };

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            main::describe(prefix, list);
            const std::size_t first = list.size();
            skip::describe(joined_name(prefix, std::string(skip_name)), list);
            for (std::size_t p = first; p < list.size(); ++p)
                list[p].offset += learnable(list[p].what) ? main::parameters : main::statistics;
        }
        static void prepare(const execution_context& p, const T* values, const T* running, memory& m) {
            main::prepare(p, values, running, m.main_memory);
            skip::prepare(p, values + main::parameters, running + main::statistics, m.skip_memory);
        }
        static void infer(const execution_context& p, const T* values, const T* running, memory& m,
                          input_view<T, Input> in, output_view<T, output> out) {
            const output_view<T, output> main_out = main_result(m, out);
            main::infer(p, values, running, m.main_memory, in, main_out);
            if constexpr (projects)
                skip::infer(p, values + main::parameters, running + main::statistics, m.skip_memory, in,
                            {m.skip_output.data(), in.samples()});
            sum<output>(p, main_out, skipped(m, in), out);
        }
        static void forward(const execution_context& p, const T* values, T* running, memory& m,
                            input_view<T, Input> in, output_view<T, output> out) {
            const output_view<T, output> main_out = main_result(m, out);
            main::forward(p, values, running, m.main_memory, in, main_out);
            if constexpr (projects)
                skip::forward(p, values + main::parameters, running + main::statistics, m.skip_memory, in,
                              {m.skip_output.data(), in.samples()});
            sum<output>(p, main_out, skipped(m, in), out);
        }
        static void backward(const execution_context& p, const T* values, memory& m, input_view<T, Input> in,
                             input_view<T, output> out, input_view<T, output> out_gradient,
                             output_view<T, Input> in_gradient, T* gradients) {
            main::backward(p, values, m.main_memory, in,
                           main::keeps_output ? input_view<T, output>(m.main_output.data(), in.samples())
                                              : out,
                           out_gradient, in_gradient, gradients);
            const T* skip_gradient = out_gradient.data();
            if constexpr (projects) {
                T* to = in_gradient.data() ? m.skip_gradient.data() : nullptr;
                skip::backward(p, values + main::parameters, m.skip_memory, in,
                               {m.skip_output.data(), in.samples()}, out_gradient, {to, in.samples()},
                               gradients + main::parameters);
                skip_gradient = to;
            }
            if (in_gradient.data() == nullptr)
                return;
            sum<Input>(p, in_gradient, {skip_gradient, in.samples()}, in_gradient);
        }

    private:
        static constexpr std::string_view skip_name = [] {
            if constexpr (detail::has_given_name<Skip>)
                return Skip::name;
            else
                return std::string_view("projection");
        }();
        /// The sum may take the place of the main branch's result unless the way back needs that.
        static output_view<T, output> main_result(memory& m, output_view<T, output> out) {
            if constexpr (main::keeps_output)
                return {m.main_output.data(), out.samples()};
            else
                return out;
        }
        static input_view<T, output> skipped(const memory& m, input_view<T, Input> in) {
            if constexpr (projects)
                return {m.skip_output.data(), in.samples()};
            else
                return {in.data(), in.samples()};
        }
        template <shape Shape>
        static void sum(const execution_context& p, input_view<T, Shape> a, input_view<T, Shape> b,
                        output_view<T, Shape> to) {
            p.threads.for_each(to.lane_blocks(), [&](std::size_t g) {
                kernels::add(a.lane_block(g), b.lane_block(g), to.lane_block(g), to.lane_block_size);
            });
        }
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet
