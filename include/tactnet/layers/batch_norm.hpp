#pragma once

#include <tactnet/kernels/batch/normalisation.hpp>
#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/layers/layer.hpp>

#include <cmath>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Batch normalisation (Ioffe and Szegedy, 2015): each channel is brought to mean 0 and variance 1, then to a
/// learned scale and shift. In training by the moments of the batch, afterwards by running ones. Epsilon is
/// the network's (execution_context::epsilon): the paper's text says 1e-4, its published networks 1e-5.
struct batch_norm {
    static constexpr std::string_view name = "bn";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .parameters = 2 * input.channels, .statistics = 2 * input.channels};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, batch_norm> {
        static constexpr std::size_t channels = Input.channels;
        static constexpr bool by_parts = true, observes = true;

        struct memory {
            std::vector<kernels::moments> parts;     // of every group and channel
            std::vector<std::array<double, 2>> sums; // of every group and channel
            std::array<double, channels> mean, inverse_deviation;
            std::array<double, channels> gradient, product; // of the shift and of the scale
            double count;                                   // of the values in a channel
            void resize(std::size_t samples) {
                parts.resize(groups_of<T>(samples) * channels);
                sums.resize(groups_of<T>(samples) * channels);
            }
        };

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "weight", parameter_role::scale, {channels}, 0);
            describe_array(list, prefix, "bias", parameter_role::shift, {channels}, channels);
            describe_array(list, prefix, "running_mean", parameter_role::running_mean, {channels}, 0);
            describe_array(list, prefix, "running_var", parameter_role::running_variance, {channels},
                           channels);
        }

        static void infer(const execution_context& p, const T* values, const T* running, memory& m,
                          input_view<T, Input> in, output_view<T, Input> out) {
            use_running(p, running, m);
            forward(p, values, nullptr, m, in, out);
        }

        static void observe_forward(const execution_context& p, memory& m, input_view<T, Input> in) {
            p.threads.for_each(in.lane_blocks(), [&](std::size_t g) {
                for (std::size_t c = 0; c < channels; ++c)
                    observe_input(m, in, p.first_group, g, c);
            });
        }
        static void begin_forward(const execution_context& p, T* running, memory& m, std::size_t samples) {
            for (std::size_t c = 0; c < channels; ++c) {
                kernels::moments all;
                for (std::size_t g = 0; g < groups_of<T>(samples); ++g)
                    all.add(m.parts[g * channels + c]);
                m.mean[c] = all.mean;
                m.inverse_deviation[c] = 1 / std::sqrt(all.variance() + p.epsilon);
                if (all.count == 0)
                    continue;
                const double unbiased = all.count > 1 ? all.squares / (all.count - 1) : all.variance();
                running[c] += static_cast<T>(p.momentum * (all.mean - static_cast<double>(running[c])));
                running[channels + c] +=
                    static_cast<T>(p.momentum * (unbiased - static_cast<double>(running[channels + c])));
            }
        }
        static void forward(const execution_context& p, const T* values, T*, memory& m,
                            input_view<T, Input> in, output_view<T, Input> out) {
            p.threads.for_each(in.lane_blocks(), [&](std::size_t g) {
                for (std::size_t c = 0; c < channels; ++c)
                    normalise(rule(values, m, c), in.lane_block(g) + c * plane, out.lane_block(g) + c * plane,
                              plane);
            });
        }

        static void observe_backward(const execution_context& p, memory& m, input_view<T, Input> in,
                                     input_view<T, Input>, input_view<T, Input> out_gradient) {
            p.threads.for_each(in.lane_blocks(), [&](std::size_t g) {
                for (std::size_t c = 0; c < channels; ++c) {
                    const T *x = in.lane_block(g) + c * plane, *dy = out_gradient.lane_block(g) + c * plane;
                    observe_channel(m, p.first_group + g, c, Input.area(), [&](std::size_t i) {
                        return std::array<kernels::vector<T>, 2>{kernels::load(x + i), kernels::load(dy + i)};
                    });
                }
            });
        }
        static void begin_backward(const execution_context&, const T*, memory& m, std::size_t samples) {
            m.count = static_cast<double>(samples * Input.area());
            for (std::size_t c = 0; c < channels; ++c) {
                m.gradient[c] = m.product[c] = 0;
                for (std::size_t g = 0; g < groups_of<T>(samples); ++g) {
                    m.gradient[c] += m.sums[g * channels + c][0];
                    m.product[c] += m.sums[g * channels + c][1];
                }
                m.product[c] -= rest(m.mean[c]) * m.inverse_deviation[c] * m.gradient[c];
            }
        }
        static void backward(const execution_context& p, const T* values, memory& m, input_view<T, Input> in,
                             input_view<T, Input>, input_view<T, Input> out_gradient,
                             output_view<T, Input> in_gradient, T*) {
            if (in_gradient.data() == nullptr)
                return;
            p.threads.for_each(in.lane_blocks(), [&](std::size_t g) {
                const kernels::vector<T> use = kernels::lanes_in_use<T>(in.samples_in(g));
                for (std::size_t c = 0; c < channels; ++c)
                    kernels::normalise_backward(
                        gradient_rule(values, m, c), use, in.lane_block(g) + c * plane,
                        out_gradient.lane_block(g) + c * plane, in_gradient.lane_block(g) + c * plane, plane);
            });
        }
        static void end_backward(memory& m, T* gradients) {
            for (std::size_t c = 0; c < channels; ++c) {
                gradients[c] = static_cast<T>(m.product[c]);
                gradients[channels + c] = static_cast<T>(m.gradient[c]);
            }
        }

        // What layers that do more than this one share with it.

        /// Keeps the moments of a channel of a group.
        static void observe_input(memory& m, input_view<T, Input> in, std::size_t first_group, std::size_t g,
                                  std::size_t c) {
            m.parts[(first_group + g) * channels + c] =
                kernels::moments_of(in.lane_block(g) + c * plane, Input.area(), in.samples_in(g));
        }
        static void use_running(const execution_context& p, const T* running, memory& m) {
            for (std::size_t c = 0; c < channels; ++c) {
                m.mean[c] = static_cast<double>(running[c]);
                m.inverse_deviation[c] =
                    1 / std::sqrt(static_cast<double>(running[channels + c]) + p.epsilon);
            }
        }
        /// The norm of channel c.
        [[nodiscard]] static kernels::normalising<T> rule(const T* values, const memory& m, std::size_t c) {
            const double scale = static_cast<double>(values[c]) * m.inverse_deviation[c];
            return {static_cast<T>(m.mean[c]), static_cast<T>(scale),
                    static_cast<T>(static_cast<double>(values[channels + c]) - rest(m.mean[c]) * scale)};
        }
        /// Its way back, after `begin_backward`.
        [[nodiscard]] static kernels::normalising_gradient<T> gradient_rule(const T* values, const memory& m,
                                                                            std::size_t c) {
            const double inverse = m.inverse_deviation[c], fall = -inverse * (m.product[c] / m.count);
            return {static_cast<T>(m.mean[c]), static_cast<T>(fall),
                    static_cast<T>(m.gradient[c] / m.count + rest(m.mean[c]) * fall),
                    static_cast<T>(static_cast<double>(values[c]) * inverse)};
        }
        /// Keeps the sums over the elements 0 … count − 1 of a channel of a group; of those at the offset i
        /// `pair(i)` tells the input and the output's gradient.
        template <class Pair>
        static void observe_channel(memory& m, std::size_t group, std::size_t c, std::size_t count,
                                    const Pair& pair) {
            const kernels::vector<T> mean(static_cast<T>(m.mean[c])),
                scale(static_cast<T>(m.inverse_deviation[c]));
            m.sums[group * channels + c] = kernels::sum_terms<2, T>(count, [&](std::size_t i) {
                const auto [x, dy] = pair(i * kernels::lanes<T>);
                return std::array<kernels::vector<T>, 2>{dy, dy * ((x - mean) * scale)};
            });
        }

    private:
        static constexpr std::size_t plane = Input.area() * kernels::lanes<T>;

        /// What rounding takes from a mean. A large mean with a small deviation must not lose it: it goes
        /// where numbers are small again.
        static double rest(double mean) { return mean - static_cast<double>(static_cast<T>(mean)); }
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet
