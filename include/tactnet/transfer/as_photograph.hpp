#pragma once

#include <tactnet/image/resize.hpp>
#include <tactnet/image/resize_kernel.hpp>
#include <tactnet/image/three_channels.hpp>
#include <tactnet/kernels/batch/pooling.hpp>
#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/trained_layer.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/tensor/tensor.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/transfer/as_photograph_step.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Turns a pressure image into the photograph that an ImageNet network expects: resized bicubically, its
// channel repeated three times (the paper's equations 1 to 4), normalised as in the training of the weights.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The value of a resized pixel before it is normalised.
enum class resized_pixel {
    count, ///< rounded and clamped to 0 … 255, as MATLAB's imresize does with 8-bit images
    number ///< the result of the bicubic kernel
};

/// The preprocessing that weights were trained with. Values are counts, 0 … 255.
struct photograph_preprocessing {
    channel_normalisation normalise; ///< of red, green and blue
    resized_pixel pixel = resized_pixel::count;
};

/// The preprocessing of torchvision's weights: mean and standard deviation of ImageNet's channels, which
/// torchvision states for values of 0 … 1.
inline constexpr photograph_preprocessing torchvision_photograph{
    {.mean = {0.485F * 255, 0.456F * 255, 0.406F * 255},
     .scale = {1 / (0.229F * 255), 1 / (0.224F * 255), 1 / (0.225F * 255)}},
    resized_pixel::count};

/// The preprocessing of weights that descend from Caffe, such as MATLAB's: only the mean is subtracted.
[[nodiscard]] constexpr photograph_preprocessing mean_photograph(float red, float green, float blue) {
    return {{.mean = {red, green, blue}, .scale = {1, 1, 1}}, resized_pixel::count};
}

namespace detail {

/// Fills all three channels of a photograph from its first, and normalises them.
inline void spread_first_channel(std::span<float> photograph, const channel_normalisation& normalise) {
    const std::size_t area = photograph.size() / 3;
    // The first channel comes last, since all are computed from it.
    for (std::size_t channel = 3; channel-- > 0;) {
        const float mean = normalise.mean[channel], scale = normalise.scale[channel];
        const auto plane = photograph.subspan(channel * area, area);
        for (std::size_t e = 0; e < area; ++e)
            plane[e] = (photograph[e] - mean) * scale;
    }
}

} // namespace detail

/// Turns an image of compile-time size into a photograph. Uses no heap: the first channel of `to` is its
/// buffer.
template <shape Grey, shape Photograph>
void to_photograph(tensor_view<const std::uint8_t, Grey> image, const photograph_preprocessing& form,
                   tensor_view<float, Photograph> to) {
    static_assert(Grey.channels == 1 && Photograph.channels == 3,
                  "to_photograph: expected an image of one channel, and room for three");
    constexpr shape resized{Photograph.rows, Photograph.columns, 1};
    resize<Grey, resized>(image, tensor_view<float, resized>(to.data()));
    if (form.pixel == resized_pixel::count)
        for (std::size_t e = 0; e < resized.size(); ++e)
            to.data()[e] = static_cast<float>(saturate_to_count(to.data()[e]));
    detail::spread_first_channel(to.elements(), form.normalise);
}

/// Turns an image whose size is known at run time into a photograph. It resizes in double precision: rounded
/// pixels may differ by one count from those of the overload above. `to` is ordered [channel][row][column].
/// Throws std::invalid_argument for an empty image, and if a span does not have the length of its size.
inline void to_photograph(std::span<const std::uint8_t> image, extent2d grey,
                          const photograph_preprocessing& form, extent2d photograph, std::span<float> to) {
    const std::size_t area = photograph.area();
    if (to.size() != 3 * area)
        detail::throw_invalid_argument(
            {"to_photograph: expected room for ", 3 * area, " numbers, found ", to.size()});
    const auto first = to.first(area);
    if (form.pixel == resized_pixel::count) {
        const auto counts =
            resize_bicubic(image, grey.rows, grey.columns, photograph.rows, photograph.columns);
        std::copy(counts.begin(), counts.end(), first.begin());
    } else {
        const std::vector<float> numbers(image.begin(), image.end());
        const auto resized = resize_bicubic(std::span<const float>(numbers), grey.rows, grey.columns,
                                            photograph.rows, photograph.columns);
        std::copy(resized.begin(), resized.end(), first.begin());
    }
    detail::spread_first_channel(to, form.normalise);
}

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
