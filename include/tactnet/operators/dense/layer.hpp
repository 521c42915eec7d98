#pragma once

#include <tactnet/kernels/batch/lane_products.hpp>
#include <tactnet/kernels/batch/weight_gradients.hpp>
#include <tactnet/operators/layer.hpp>

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <std::size_t Outputs>
[[nodiscard]] constexpr shape dense_output() {
    static_assert(Outputs > 0, "dense: there must be at least one output");
    return {1, 1, Outputs};
}

} // namespace detail

/// Fully connected layer with bias. Weights are [output][channel][row][column]: PyTorch's order after a
/// flatten.
template <std::size_t Outputs>
struct dense {
    static constexpr std::string_view name = "fc";
    static constexpr bool numbered = false;

    static constexpr layer_costs costs(const shape& input) {
        const std::size_t weights = Outputs * input.size();
        return {.output = {1, 1, Outputs},
                .parameters = weights + Outputs,
                .multiply_adds = weights,
                .multiply_adds_on_pixels = weights};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, dense> {
        static constexpr shape output = detail::dense_output<Outputs>();
        static constexpr std::size_t inputs = Input.size(), weights = Outputs * inputs;
        // Not by parts: totals of all weights would be too large to keep while other layers compute.

        struct memory {
            aligned_vector<double> totals; // of every thread: [output][lane]
            void resize(std::size_t) {}
        };

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "weight", parameter_role::weight, {Outputs, inputs}, 0, inputs,
                           Input);
            describe_array(list, prefix, "bias", parameter_role::bias, {Outputs}, weights);
        }

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
                             input_view<T, Input> in, input_view<T, output>,
                             input_view<T, output> out_gradient, output_view<T, Input> in_gradient,
                             T* gradients) {
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
};

}} // namespace tactnet
