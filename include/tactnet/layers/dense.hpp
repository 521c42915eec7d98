#pragma once

#include <tactnet/kernels/gemm.hpp>
#include <tactnet/kernels/reductions.hpp>
#include <tactnet/layers/layer.hpp>

#include <array>

namespace tactnet::inline TACTNET_ARCH {

namespace detail {

template <std::size_t Outputs>
[[nodiscard]] constexpr shape dense_output() {
    static_assert(Outputs > 0, "dense: there must be at least one output");
    return {1, 1, Outputs};
}

} // namespace detail

/// Fully connected layer with bias. Weights are [output][channel][row][column]: PyTorch's order behind a
/// flatten.
template <std::size_t Outputs>
struct dense {
    static constexpr std::string_view name = "fc";
    static constexpr bool numbered = false;

    template <class T, shape Input>
    struct layer : layer_without_parameters<T, Input, shape{1, 1, Outputs}> {
        static constexpr shape output = detail::dense_output<Outputs>();
        static constexpr std::size_t inputs = Input.size(), weights = Outputs * inputs;
        static constexpr std::size_t parameters = weights + Outputs;
        static constexpr std::size_t multiply_adds = weights, multiply_adds_on_pixels = weights;

        struct memory {
            aligned_vector<T> parts;                         // of every group
            std::array<aligned_vector<double>, Outputs> row; // of every output
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

        static void backward(const pass& p, const T* values, memory& m, input_view<T, Input> in,
                             input_view<T, output>, input_view<T, output> out_gradient,
                             output_view<T, Input> in_gradient, T* gradients) {
            // One product for each group, always of the same size: its rounding must not depend on the
            // threads.
            m.parts.resize(in.groups() * weights);
            p.threads.for_each(in.groups(), [&](std::size_t g) {
                multiply_transposed_right(out_gradient.group(g), in.group(g), m.parts.data() + g * weights,
                                          Outputs, lanes<T>, inputs);
            });
            p.threads.for_each(Outputs, [&](std::size_t o) {
                m.row[o].assign(inputs, 0.0);
                double bias = 0;
                for (std::size_t g = 0; g < in.groups(); ++g) {
                    const T* part = m.parts.data() + g * weights + o * inputs;
                    for (std::size_t i = 0; i < inputs; ++i)
                        m.row[o][i] += static_cast<double>(part[i]);
                    bias += sum_terms<1, T>(1, [&](std::size_t) {
                        return std::array<vector<T>, 1>{load(out_gradient.group(g) + o * lanes<T>)};
                    })[0];
                }
                for (std::size_t i = 0; i < inputs; ++i)
                    gradients[o * inputs + i] = static_cast<T>(m.row[o][i]);
                gradients[weights + o] = static_cast<T>(bias);
            });
            if (in_gradient.data() == nullptr)
                return;
            p.threads.for_each(in.groups(), [&](std::size_t g) {
                multiply_transposed_left(values, out_gradient.group(g), in_gradient.group(g), inputs, Outputs,
                                         lanes<T>);
            });
        }
    };
};

} // namespace tactnet
