#pragma once

#include <tactnet/image/resize_kernel.hpp>
#include <tactnet/kernels/batch/pooling.hpp>
#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/trained_layer.hpp>
#include <tactnet/transfer/as_photograph_step.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <std::size_t Channels, std::size_t Rows, std::size_t Columns>
[[nodiscard]] constexpr shape photograph_output() {
    static_assert(Channels == 1, "as_photograph: the input must be an image of one channel");
    static_assert(Rows > 0 && Columns > 0, "as_photograph: there must be at least one row and one column");
    return {Rows, Columns, 3};
}

} // namespace detail

/// Turns an image of one channel into the photograph that an ImageNet network expects: resizes it
/// bicubically, repeats its channel three times (the paper's equations 1 to 4), subtracts a mean and divides
/// by a standard deviation. Mean and variance of red, green and blue are running statistics that training
/// does not change, in weight files "photograph.running_mean" and "photograph.running_var". pretrained_trunk
/// sets them together with the weights of the network. Until then the mean is 0 and the variance 1; no
/// epsilon is added.
template <extent2d Size>
struct as_photograph {
    static constexpr std::string_view name = "photograph";
    static constexpr bool numbered = false;

    static constexpr layer_costs costs(const shape&) {
        return {.output = {Size.rows, Size.columns, 3}, .statistics = 6};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, as_photograph> {
        static constexpr shape output = detail::photograph_output<Input.channels, Size.rows, Size.columns>();
        using down = resize_axis<keys_cubic<>, Input.rows, Size.rows>;
        using along = resize_axis<keys_cubic<>, Input.columns, Size.columns>;

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "running_mean", parameter_role::running_mean, {3}, 0);
            describe_array(list, prefix, "running_var", parameter_role::running_variance, {3}, 3);
        }
    };
};

template <extent2d Size, class T, shape Input>
struct trained_layer<as_photograph<Size>, T, Input> : trained_base<as_photograph<Size>, T, Input> {
    using base = trained_base<as_photograph<Size>, T, Input>;
    using base::output;
    using typename base::along, typename base::down;
    static constexpr bool by_parts = true;

    struct memory {
        std::array<T, 3> mean{}, scale{};
        void resize(std::size_t) {}
    };

    static void prepare(const execution_context&, const T*, const T* running, memory& m) {
        for (std::size_t channel = 0; channel < 3; ++channel) {
            m.mean[channel] = running[channel];
            m.scale[channel] = 1 / std::sqrt(running[3 + channel]);
        }
    }
    static void infer(const execution_context& p, const T*, const T*, memory& m, input_view<T, Input> in,
                      output_view<T, output> out) {
        using vector = kernels::vector<T>;
        p.threads.for_each(in.lane_blocks(), [&](std::size_t g) {
            T* const to = out.lane_block(g);
            kernels::resample_lanes<T, down, along>(
                in.lane_block(g), [&](std::size_t pixel, const vector& value) {
                    for (std::size_t channel = 0; channel < 3; ++channel)
                        kernels::store(to + (channel * output.area() + pixel) * kernels::lanes<T>,
                                       (value - vector(m.mean[channel])) * vector(m.scale[channel]));
                });
        });
    }
    static void backward(const execution_context& p, const T*, memory& m, input_view<T, Input>,
                         input_view<T, output>, input_view<T, output> out_gradient,
                         output_view<T, Input> in_gradient, T*) {
        using vector = kernels::vector<T>;
        if (in_gradient.data() == nullptr)
            return;
        p.threads.for_each(out_gradient.lane_blocks(), [&](std::size_t g) {
            const T* const from = out_gradient.lane_block(g);
            kernels::resample_lanes_backward<T, down, along>(
                [&](std::size_t pixel) {
                    vector sum(T{0});
                    for (std::size_t channel = 0; channel < 3; ++channel)
                        sum = kernels::multiply_add<T>(
                            vector(m.scale[channel]),
                            kernels::load<T>(from + (channel * output.area() + pixel) * kernels::lanes<T>),
                            sum);
                    return sum;
                },
                in_gradient.lane_block(g));
        });
    }
};

/// Lowers as_photograph to its deployed step.
template <extent2d Size>
struct lowering<as_photograph<Size>> {
    template <class Place>
    struct at {
        using step = as_photograph_step<typename Place::format,
                                        extent2d{Place::layer::input.rows, Place::layer::input.columns},
                                        Place::input_stride, Size>;
        static void fold(const parameter_source& list, float* to) {
            const float* const statistics = Place::parameters(list).statistics;
            for (std::size_t channel = 0; channel < 3; ++channel) {
                to[channel] = statistics[channel];
                to[3 + channel] =
                    static_cast<float>(1 / std::sqrt(static_cast<double>(statistics[3 + channel])));
            }
        }
    };
};

}} // namespace tactnet
