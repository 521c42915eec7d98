#pragma once

#include <tactnet/kernels/gemm.hpp>
#include <tactnet/kernels/reductions.hpp>
#include <tactnet/layers/layer.hpp>

namespace tactnet::inline TACTNET_ARCH {

/// Fully connected layer with bias. Weights are [output][channel][row][column]: PyTorch's order behind a flatten.
template <std::size_t Outputs>
struct dense {
    static constexpr std::string_view name = "fc";
    static constexpr bool numbered = false;

    template <class T, shape Input>
    struct layer : layer_without_parameters<T, Input, shape{1, 1, Outputs}> {
        static_assert(Outputs > 0, "dense: there must be at least one output");
        static constexpr shape output{1, 1, Outputs};
        static constexpr std::size_t inputs = Input.size(), weights = Outputs * inputs;
        static constexpr std::size_t parameters = weights + Outputs;
        static constexpr std::size_t multiply_adds = weights, multiply_adds_on_pixels = weights;

        struct memory {
            aligned_vector<double> totals;
            aligned_vector<T> part;
            void resize(std::size_t) {}
        };

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix + ".weight", role::weight, {Outputs, inputs}, 0, inputs);
            describe_array(list, prefix + ".bias", role::bias, {Outputs}, weights);
        }

        static void infer(const pass& p, const T* values, const T*, memory&, input_view<T, Input> in,
                          output_view<T, output> out) {
            p.threads.for_each(in.groups(), [&](std::size_t g) {
                multiply(values, in.group(g), out.group(g), Outputs, inputs, lanes<T>);
                for (std::size_t o = 0; o < Outputs; ++o) {
                    T* to = out.group(g) + o * lanes<T>;
                    store(to, load<T>(to) + vector<T>(values[weights + o]));
                }
            });
        }
        static void forward(const pass& p, const T* values, T* none, memory& m, input_view<T, Input> in,
                            output_view<T, output> out) {
            infer(p, values, none, m, in, out);
        }

        static void backward(const pass& p, const T* values, memory& m, input_view<T, Input> in, input_view<T, output>,
                             input_view<T, output> out_gradient, output_view<T, Input> in_gradient, T* gradients) {
            m.totals.assign(parameters, 0.0);
            m.part.resize(weights);
            // Rows of the weight matrix are shared out; every thread adds the groups in the same order.
            p.threads.for_each_share(Outputs, [&](std::size_t begin, std::size_t end) {
                for (std::size_t g = 0; g < in.groups(); ++g) {
                    const T* dy = out_gradient.group(g) + begin * lanes<T>;
                    multiply_transposed_right(dy, in.group(g), m.part.data() + begin * inputs, end - begin, lanes<T>,
                                              inputs);
                    for (std::size_t i = begin * inputs; i < end * inputs; ++i)
                        m.totals[i] += static_cast<double>(m.part[i]);
                    for (std::size_t o = begin; o < end; ++o)
                        m.totals[weights + o] += sum_terms<1, T>(1, [&](std::size_t) {
                            return std::array<vector<T>, 1>{load(out_gradient.group(g) + o * lanes<T>)};
                        })[0];
                }
            });
            for (std::size_t i = 0; i < parameters; ++i)
                gradients[i] = static_cast<T>(m.totals[i]);
            if (in_gradient.data() == nullptr)
                return;
            p.threads.for_each(in.groups(), [&](std::size_t g) {
                multiply_transposed_left(values, out_gradient.group(g), in_gradient.group(g), inputs, Outputs, lanes<T>);
            });
        }
    };
};

} // namespace tactnet
