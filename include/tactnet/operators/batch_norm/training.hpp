#pragma once

#include <tactnet/kernels/batch/normalisation.hpp>
#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/operators/batch_norm/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

template <class T, shape Input>
struct trained_layer<batch_norm, T, Input> : trained_base<batch_norm, T, Input> {
    using base = trained_base<batch_norm, T, Input>;
    using base::channels;
    static constexpr bool by_parts = true, observes = true;

    struct memory {
        std::vector<kernels::moments> parts;     // of every lane block and channel
        std::vector<std::array<double, 2>> sums; // of every lane block and channel
        std::array<double, channels> mean, inverse_deviation;
        std::array<double, channels> gradient, product; // of the shift and of the scale
        double count;                                   // of the values in a channel
        void resize(std::size_t samples) {
            parts.resize(lane_blocks_of<T>(samples) * channels);
            sums.resize(lane_blocks_of<T>(samples) * channels);
        }
    };

    static void infer(const execution_context& context, const T* values, const T* running, memory& m,
                      input_view<T, Input> in, output_view<T, Input> out) {
        use_running(context, running, m);
        forward(context, values, nullptr, m, in, out);
    }

    static void observe_forward(const execution_context& context, memory& m, input_view<T, Input> in) {
        each_channel(context, in.lane_blocks(), [&](std::size_t b, std::size_t c) {
            observe_input(m, in, context.first_lane_block, b, c);
        });
    }
    static void begin_forward(const execution_context& context, T* running, memory& m, std::size_t samples) {
        for (std::size_t c = 0; c < channels; ++c) {
            kernels::moments all;
            for (std::size_t b = 0; b < lane_blocks_of<T>(samples); ++b)
                all.add(m.parts[b * channels + c]);
            m.mean[c] = all.mean;
            m.inverse_deviation[c] = 1 / std::sqrt(all.variance() + context.epsilon);
            if (all.count == 0)
                continue;
            const double unbiased = all.count > 1 ? all.squares / (all.count - 1) : all.variance();
            running[c] += static_cast<T>(context.momentum * (all.mean - static_cast<double>(running[c])));
            running[channels + c] +=
                static_cast<T>(context.momentum * (unbiased - static_cast<double>(running[channels + c])));
        }
    }
    static void forward(const execution_context& context, const T* values, T*, memory& m,
                        input_view<T, Input> in, output_view<T, Input> out) {
        each_channel(context, in.lane_blocks(), [&](std::size_t b, std::size_t c) {
            normalise(rule(values, m, c), in.lane_block(b) + c * plane, out.lane_block(b) + c * plane, plane);
        });
    }

    static void observe_backward(const execution_context& context, memory& m, input_view<T, Input> in,
                                 input_view<T, Input>, input_view<T, Input> out_gradient) {
        each_channel(context, in.lane_blocks(), [&](std::size_t b, std::size_t c) {
            const T *x = in.lane_block(b) + c * plane, *dy = out_gradient.lane_block(b) + c * plane;
            observe_channel(m, context.first_lane_block + b, c, Input.area(), [&](std::size_t i) {
                return std::array<kernels::vector<T>, 2>{kernels::load(x + i), kernels::load(dy + i)};
            });
        });
    }
    static void begin_backward(const execution_context&, const T*, memory& m, std::size_t samples) {
        m.count = static_cast<double>(samples * Input.area());
        for (std::size_t c = 0; c < channels; ++c) {
            m.gradient[c] = m.product[c] = 0;
            for (std::size_t b = 0; b < lane_blocks_of<T>(samples); ++b) {
                m.gradient[c] += m.sums[b * channels + c][0];
                m.product[c] += m.sums[b * channels + c][1];
            }
            m.product[c] -= rest(m.mean[c]) * m.inverse_deviation[c] * m.gradient[c];
        }
    }
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, Input>, input_view<T, Input> out_gradient,
                         output_view<T, Input> in_gradient, T*) {
        if (in_gradient.data() == nullptr)
            return;
        each_channel(context, in.lane_blocks(), [&](std::size_t b, std::size_t c) {
            kernels::normalise_backward(gradient_rule(values, m, c),
                                        kernels::lanes_in_use<T>(in.samples_in(b)),
                                        in.lane_block(b) + c * plane, out_gradient.lane_block(b) + c * plane,
                                        in_gradient.lane_block(b) + c * plane, plane);
        });
    }
    static void end_backward(memory& m, T* gradients) {
        for (std::size_t c = 0; c < channels; ++c) {
            gradients[c] = static_cast<T>(m.product[c]);
            gradients[channels + c] = static_cast<T>(m.gradient[c]);
        }
    }

    // Shared with norm_relu_pool.

    /// Calls body(lane block, channel).
    template <class Body>
    static void each_channel(const execution_context& context, std::size_t lane_blocks, const Body& body) {
        context.threads.for_each(lane_blocks, [&](std::size_t b) {
            for (std::size_t c = 0; c < Input.channels; ++c)
                body(b, c);
        });
    }
    /// Keeps the moments of a channel of a lane block.
    static void observe_input(memory& m, input_view<T, Input> in, std::size_t first_lane_block, std::size_t b,
                              std::size_t c) {
        m.parts[(first_lane_block + b) * channels + c] =
            kernels::moments_of(in.lane_block(b) + c * plane, Input.area(), in.samples_in(b));
    }
    static void use_running(const execution_context& context, const T* running, memory& m) {
        for (std::size_t c = 0; c < channels; ++c) {
            m.mean[c] = static_cast<double>(running[c]);
            m.inverse_deviation[c] =
                1 / std::sqrt(static_cast<double>(running[channels + c]) + context.epsilon);
        }
    }
    /// The norm of channel c.
    [[nodiscard]] static kernels::normalising<T> rule(const T* values, const memory& m, std::size_t c) {
        const double scale = static_cast<double>(values[c]) * m.inverse_deviation[c];
        return {static_cast<T>(m.mean[c]), static_cast<T>(scale),
                static_cast<T>(static_cast<double>(values[channels + c]) - rest(m.mean[c]) * scale)};
    }
    /// Its gradient, after `begin_backward`.
    [[nodiscard]] static kernels::normalising_gradient<T> gradient_rule(const T* values, const memory& m,
                                                                        std::size_t c) {
        const double inverse = m.inverse_deviation[c], fall = -inverse * (m.product[c] / m.count);
        return {static_cast<T>(m.mean[c]), static_cast<T>(fall),
                static_cast<T>(m.gradient[c] / m.count + rest(m.mean[c]) * fall),
                static_cast<T>(static_cast<double>(values[c]) * inverse)};
    }
    /// Keeps the sums over the elements 0 … count − 1 of a channel of a lane block. `pair(i)` returns the
    /// input and the output's gradient at the offset i.
    template <class Pair>
    static void observe_channel(memory& m, std::size_t lane_block, std::size_t c, std::size_t count,
                                const Pair& pair) {
        const kernels::vector<T> mean(static_cast<T>(m.mean[c])),
            scale(static_cast<T>(m.inverse_deviation[c]));
        m.sums[lane_block * channels + c] = kernels::sum_terms<2, T>(count, [&](std::size_t i) {
            const auto [x, dy] = pair(i * kernels::lanes<T>);
            return std::array<kernels::vector<T>, 2>{dy, dy * ((x - mean) * scale)};
        });
    }

private:
    static constexpr std::size_t plane = Input.area() * kernels::lanes<T>;

    /// The rounding error of a mean, which a large mean with a small deviation must not lose: it is added
    /// where numbers are small again.
    static double rest(double mean) { return mean - static_cast<double>(static_cast<T>(mean)); }
};

template <class T, shape Input>
struct trained_layer<channel_scale, T, Input> : trained_base<channel_scale, T, Input> {
    static constexpr bool by_parts = true;

    struct memory {
        std::vector<double> sums; // of every lane block and channel
        void resize(std::size_t) {}
    };

    static void infer(const execution_context& context, const T* values, const T*, memory&,
                      input_view<T, Input> in, output_view<T, Input> out) {
        scale(context, values, in, out);
    }
    static void begin_backward(const execution_context&, const T*, memory& m, std::size_t samples) {
        m.sums.resize(lane_blocks_of<T>(samples) * Input.channels);
    }
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, Input>, input_view<T, Input> out_gradient,
                         output_view<T, Input> in_gradient, T*) {
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            for (std::size_t c = 0; c < Input.channels; ++c) {
                const T *x = in.lane_block(b) + c * plane, *dy = out_gradient.lane_block(b) + c * plane;
                m.sums[(context.first_lane_block + b) * Input.channels + c] =
                    kernels::sum_terms<1, T>(Input.area(), [&](std::size_t i) {
                        return std::array<kernels::vector<T>, 1>{kernels::load(x + i * kernels::lanes<T>) *
                                                                 kernels::load(dy + i * kernels::lanes<T>)};
                    })[0];
            }
        });
        if (in_gradient.data() != nullptr)
            scale(context, values, out_gradient, in_gradient);
    }
    static void end_backward(memory& m, T* gradients) {
        for (std::size_t c = 0; c < Input.channels; ++c) {
            double sum = 0;
            for (std::size_t at = c; at < m.sums.size(); at += Input.channels)
                sum += m.sums[at];
            gradients[c] = static_cast<T>(sum);
        }
    }

private:
    static constexpr std::size_t plane = Input.area() * kernels::lanes<T>;

    static void scale(const execution_context& context, const T* values, input_view<T, Input> in,
                      output_view<T, Input> out) {
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            for (std::size_t c = 0; c < Input.channels; ++c)
                kernels::normalise(kernels::normalising<T>{0, values[c], 0}, in.lane_block(b) + c * plane,
                                   out.lane_block(b) + c * plane, plane);
        });
    }
};

}} // namespace tactnet
