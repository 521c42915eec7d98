#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/kernels/reductions.hpp>
#include <tactnet/layers/layer.hpp>

#include <cmath>

namespace tactnet::inline TACTNET_ARCH {

/// Batch normalisation (Ioffe and Szegedy, 2015): each channel is brought to mean 0 and variance 1, then to a
/// learned scale and shift. In training by the moments of the batch, afterwards by running ones. Epsilon is
/// the network's (pass::epsilon): the paper's text says 1e-4, its published networks 1e-5.
struct batch_norm {
    static constexpr std::string_view name = "bn";
    static constexpr bool numbered = true;

    template <class T, shape Input>
    struct layer : layer_without_parameters<T, Input, Input> {
        static constexpr std::size_t channels = Input.channels;
        static constexpr std::size_t parameters = 2 * channels, statistics = 2 * channels;

        struct memory {
            std::vector<moments> parts;              // of every group and channel
            std::vector<std::array<double, 2>> sums; // of every group and channel
            std::array<double, channels> mean, inverse_deviation;
            void resize(std::size_t samples) {
                const std::size_t groups = (samples + lanes<T> - 1) / lanes<T>;
                parts.resize(groups * channels);
                sums.resize(groups * channels);
            }
        };

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix + ".weight", role::scale, {channels}, 0);
            describe_array(list, prefix + ".bias", role::shift, {channels}, channels);
            describe_array(list, prefix + ".running_mean", role::running_mean, {channels}, 0);
            describe_array(list, prefix + ".running_var", role::running_variance, {channels}, channels);
        }

        static void infer(const pass& p, const T* values, const T* running, memory& m,
                          input_view<T, Input> in, output_view<T, Input> out) {
            for (std::size_t c = 0; c < channels; ++c) {
                m.mean[c] = static_cast<double>(running[c]);
                m.inverse_deviation[c] =
                    1 / std::sqrt(static_cast<double>(running[channels + c]) + p.epsilon);
            }
            apply(p, values, m, in, out);
        }

        static void forward(const pass& p, const T* values, T* running, memory& m, input_view<T, Input> in,
                            output_view<T, Input> out) {
            p.threads.for_each(in.groups(), [&](std::size_t g) {
                for (std::size_t c = 0; c < channels; ++c)
                    m.parts[g * channels + c] =
                        moments_of(in.group(g) + c * plane, Input.area(), in.samples_in(g));
            });
            for (std::size_t c = 0; c < channels; ++c) {
                moments all;
                for (std::size_t g = 0; g < in.groups(); ++g)
                    all.add(m.parts[g * channels + c]);
                m.mean[c] = all.mean;
                m.inverse_deviation[c] = 1 / std::sqrt(all.variance() + p.epsilon);
                const double unbiased = all.count > 1 ? all.squares / (all.count - 1) : all.variance();
                running[c] += static_cast<T>(p.momentum * (all.mean - static_cast<double>(running[c])));
                running[channels + c] +=
                    static_cast<T>(p.momentum * (unbiased - static_cast<double>(running[channels + c])));
            }
            apply(p, values, m, in, out);
        }

        static void backward(const pass& p, const T* values, memory& m, input_view<T, Input> in,
                             input_view<T, Input>, input_view<T, Input> out_gradient,
                             output_view<T, Input> in_gradient, T* gradients) {
            p.threads.for_each(in.groups(), [&](std::size_t g) {
                for (std::size_t c = 0; c < channels; ++c) {
                    const T *x = in.group(g) + c * plane, *dy = out_gradient.group(g) + c * plane;
                    const vector<T> mean(static_cast<T>(m.mean[c])),
                        scale(static_cast<T>(m.inverse_deviation[c]));
                    m.sums[g * channels + c] = sum_terms<2, T>(Input.area(), [&](std::size_t i) {
                        const vector<T> d = load(dy + i * lanes<T>);
                        return std::array<vector<T>, 2>{d, d * ((load(x + i * lanes<T>) - mean) * scale)};
                    });
                }
            });
            const double count = static_cast<double>(in.samples() * Input.area());
            std::array<double, channels> mean_gradient{}, mean_product{};
            for (std::size_t c = 0; c < channels; ++c) {
                for (std::size_t g = 0; g < in.groups(); ++g) {
                    mean_gradient[c] += m.sums[g * channels + c][0];
                    mean_product[c] += m.sums[g * channels + c][1];
                }
                mean_product[c] -= rest(m.mean[c]) * m.inverse_deviation[c] * mean_gradient[c];
                gradients[c] = static_cast<T>(mean_product[c]);
                gradients[channels + c] = static_cast<T>(mean_gradient[c]);
                mean_gradient[c] /= count;
                mean_product[c] /= count;
            }
            if (in_gradient.data() == nullptr)
                return;
            p.threads.for_each(in.groups(), [&](std::size_t g) {
                const vector<T> use = lanes_in_use<T>(in.samples_in(g));
                for (std::size_t c = 0; c < channels; ++c) {
                    const T *x = in.group(g) + c * plane, *dy = out_gradient.group(g) + c * plane;
                    T* dx = in_gradient.group(g) + c * plane;
                    const double inverse = m.inverse_deviation[c], fall = -inverse * mean_product[c];
                    const vector<T> mean(static_cast<T>(m.mean[c])), slope(static_cast<T>(fall)),
                        level(static_cast<T>(mean_gradient[c] + rest(m.mean[c]) * fall));
                    const vector<T> scale =
                        vector<T>(static_cast<T>(static_cast<double>(values[c]) * inverse)) * use;
                    for (std::size_t i = 0; i < plane; i += lanes<T>)
                        store(dx + i,
                              multiply_add<T>(load(x + i) - mean, slope, load(dy + i) - level) * scale);
                }
            });
        }

    private:
        static constexpr std::size_t plane = Input.area() * lanes<T>;

        /// What rounding takes from a mean. A large mean with a small deviation must not lose it: it goes
        /// where numbers are small again.
        static double rest(double mean) { return mean - static_cast<double>(static_cast<T>(mean)); }

        static void apply(const pass& p, const T* values, const memory& m, input_view<T, Input> in,
                          output_view<T, Input> out) {
            p.threads.for_each(in.groups(), [&](std::size_t g) {
                for (std::size_t c = 0; c < channels; ++c) {
                    const double scale = static_cast<double>(values[c]) * m.inverse_deviation[c];
                    const double shift = static_cast<double>(values[channels + c]) - rest(m.mean[c]) * scale;
                    normalise(in.group(g) + c * plane, out.group(g) + c * plane, plane,
                              static_cast<T>(m.mean[c]), static_cast<T>(scale), static_cast<T>(shift));
                }
            });
        }
    };
};

} // namespace tactnet
