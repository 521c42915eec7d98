#pragma once

#include <tactnet/kernels/batch/channel_factors.hpp>
#include <tactnet/operators/sequence/layer.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t BranchRows, std::size_t BranchColumns, std::size_t BranchChannels, std::size_t Channels>
concept gives_factor_per_channel = (BranchRows == 1) && (BranchColumns == 1) && (BranchChannels == Channels);

namespace detail {

template <std::size_t BranchRows, std::size_t BranchColumns, std::size_t BranchChannels, std::size_t Channels>
[[nodiscard]] constexpr shape gate_output(shape input) {
    static_assert(gives_factor_per_channel<BranchRows, BranchColumns, BranchChannels, Channels>,
                  "gate: the branch must give one factor for each channel of the input, in one pixel; "
                  "gives_factor_per_channel shows rows, columns and channels of the branch, then channels "
                  "of the input");
    return input;
}

} // namespace detail

/// The input times a factor for each channel, which a branch of layers computes from the input: y(c, p) =
/// x(c, p) · branch(x)(c). The branch gives a map of 1 × 1 with as many channels as the input: it begins with
/// a global pool and ends in a sigmoid, as in squeeze_excitation.hpp, or in another function.
template <class... Branch>
struct gate {
    static constexpr std::string_view name = "gate";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        const layer_costs branch = sequence<Branch...>::costs(input);
        layer_costs product{.output = input,
                            .inner_activations = branch.output.size() + branch.inner_activations};
        product.add(branch);
        return product;
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, gate> { // the branch has stages of its own
        using branch = typename sequence<Branch...>::template layer<T, Input>;
        static constexpr shape output = detail::gate_output<branch::output.rows, branch::output.columns,
                                                            branch::output.channels, Input.channels>(Input);

        struct memory {
            typename branch::memory branch_memory;
            aligned_vector<T> factors, factor_gradients;
            void resize(std::size_t samples) {
                branch_memory.resize(samples);
                detail::grow(factors, kernels::padded_size<T>(samples) * branch::output.size());
            }
        };

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            branch::describe(prefix, list);
        }
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
                             input_view<T, Input> in, input_view<T, output>,
                             input_view<T, output> out_gradient, output_view<T, Input> in_gradient,
                             T* gradients) {
            const factor_view factors(m.factors.data(), in.samples());
            detail::grow(m.factor_gradients, m.factors.size());
            const output_view<T, branch::output> factor_gradients(m.factor_gradients.data(), in.samples());
            context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
                kernels::multiply_channels_backward(Input.channels, Input.area(), in.lane_block(b),
                                                    out_gradient.lane_block(b),
                                                    factor_gradients.lane_block(b));
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
                kernels::multiply_channels(Input.channels, Input.area(), in.lane_block(b),
                                           factors.lane_block(b), out.lane_block(b));
            });
        }
    };
};

}} // namespace tactnet
