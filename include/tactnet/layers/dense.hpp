#pragma once

#include <tactnet/kernels/batch/lane_products.hpp>
#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/transpose.hpp>
#include <tactnet/layers/layer.hpp>

#include <algorithm>
#include <array>
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
            // Threads share the outputs for the biases, and the inputs, a vector at a time, for the weights.
            // Each adds all lane blocks in order.
            m.totals.resize(context.threads.threads() * Outputs * kernels::lanes<T>);
            context.threads.on_each_thread([&](thread_pool::share part) {
                for (std::size_t o = part.begin(Outputs); o < part.end(Outputs); ++o) {
                    double bias = 0;
                    for (std::size_t b = 0; b < in.lane_blocks(); ++b)
                        bias += kernels::sum_terms<1, T>(1, [&](std::size_t) {
                            return std::array<kernels::vector<T>, 1>{
                                kernels::load(out_gradient.lane_block(b) + o * kernels::lanes<T>)};
                        })[0];
                    gradients[weights + o] = static_cast<T>(bias);
                }
                double* totals = m.totals.data() + part.index * Outputs * kernels::lanes<T>;
                for (std::size_t v = part.begin(vectors); v < part.end(vectors); ++v) {
                    const std::size_t first = v * kernels::lanes<T>,
                                      count = std::min(kernels::lanes<T>, inputs - first);
                    std::fill_n(totals, Outputs * kernels::lanes<T>, 0.0);
                    for (std::size_t b = 0; b < in.lane_blocks(); ++b)
                        add_products(out_gradient.lane_block(b), in.lane_block(b) + first * kernels::lanes<T>,
                                     count, totals);
                    for (std::size_t o = 0; o < Outputs; ++o)
                        for (std::size_t i = 0; i < count; ++i)
                            gradients[o * inputs + first + i] =
                                static_cast<T>(totals[o * kernels::lanes<T> + i]);
                }
            });
            if (in_gradient.data() == nullptr)
                return;
            context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
                kernels::lane_product<inputs, Outputs, kernels::matrix_layout{1, inputs}>(
                    values, out_gradient.lane_block(b), [&](std::size_t i, const kernels::vector<T>& sum) {
                        kernels::store(in_gradient.lane_block(b) + i * kernels::lanes<T>, sum);
                    });
            });
        }

    private:
        static constexpr std::size_t vectors = kernels::padded_size<T>(inputs) / kernels::lanes<T>;

        /// Adds the gradients of the weights between up to `lanes<T>` inputs and all outputs, summed over the
        /// samples of one lane block.
        static void add_products(const T* out_gradient, const T* in, std::size_t count, double* totals) {
            alignas(vector_alignment) std::array<T, kernels::lanes<T> * kernels::lanes<T>> turned;
            kernels::transpose(in, count, turned.data());
            kernels::lane_product<Outputs, kernels::lanes<T>, kernels::matrix_layout{kernels::lanes<T>, 1}>(
                out_gradient, turned.data(), [&](std::size_t o, const kernels::vector<T>& sum) {
                    kernels::add_each_lane<T>(totals + o * kernels::lanes<T>, sum);
                });
        }
    };
};

}} // namespace tactnet
