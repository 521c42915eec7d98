#pragma once

#include <tactnet/kernels/batch/pooling.hpp>
#include <tactnet/operators/pooling/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <extent2d Window, extent2d Stride, padding Padding, class T, shape Input>
struct trained_layer<max_pool<Window, Stride, Padding>, T, Input>
    : lane_block_layer<max_pool<Window, Stride, Padding>, T, Input> {
    using base = lane_block_layer<max_pool<Window, Stride, Padding>, T, Input>;
    using base::window;
    static void forward_block(const T* in, T* out) { kernels::max_pool_forward<window>(in, out); }
    static void backward_block(const T* in, const T* out, const T* out_gradient, T* in_gradient) {
        kernels::max_pool_backward<window>(in, out, out_gradient, in_gradient);
    }
};

template <class T, shape Input>
struct trained_layer<global_max_pool, T, Input>
    : trained_layer<max_pool<extent2d(Input.rows, Input.columns), 1, padding::valid>, T, Input> {};

template <extent2d Output, class T, shape Input>
struct trained_layer<adaptive_max_pool<Output>, T, Input>
    : lane_block_layer<adaptive_max_pool<Output>, T, Input> {
    using base = lane_block_layer<adaptive_max_pool<Output>, T, Input>;
    using base::windows;
    static void forward_block(const T* in, T* out) {
        kernels::max_pool_forward(windows, Input.channels, in, out);
    }
    static void backward_block(const T* in, const T* out, const T* out_gradient, T* in_gradient) {
        kernels::max_pool_backward(windows, Input.channels, in, out, out_gradient, in_gradient);
    }
};

namespace detail {

template <class Spec, class T, shape Input>
struct trained_average : lane_block_layer<Spec, T, Input> {
    using lane_block_layer<Spec, T, Input>::windows;

    static void forward_block(const T* in, T* out) {
        kernels::average_pool_forward(windows, Input.channels, in, out);
    }
    static void backward_block(const T*, const T*, const T* out_gradient, T* in_gradient) {
        kernels::average_pool_backward(windows, Input.channels, out_gradient, in_gradient);
    }
};

} // namespace detail

template <extent2d Window, extent2d Stride, padding Padding, average_over Over, class T, shape Input>
struct trained_layer<average_pool<Window, Stride, Padding, Over>, T, Input>
    : detail::trained_average<average_pool<Window, Stride, Padding, Over>, T, Input> {};
template <extent2d Output, class T, shape Input>
struct trained_layer<adaptive_average_pool<Output>, T, Input>
    : detail::trained_average<adaptive_average_pool<Output>, T, Input> {};

namespace detail {

template <class Spec, class T, shape Input>
struct trained_resampling : lane_block_layer<Spec, T, Input> {
    using lane_block_layer<Spec, T, Input>::output, lane_block_layer<Spec, T, Input>::mode;

    static void forward_block(const T* in, T* out) {
        for (std::size_t channel = 0; channel < Input.channels; ++channel) {
            T* const to = out + channel * output_plane;
            kernels::resample_lanes<T, down, along>(in + channel * input_plane,
                                                    [&](std::size_t pixel, const kernels::vector<T>& value) {
                                                        kernels::store(to + pixel * kernels::lanes<T>, value);
                                                    });
        }
    }
    static void backward_block(const T*, const T*, const T* out_gradient, T* in_gradient) {
        for (std::size_t channel = 0; channel < Input.channels; ++channel) {
            const T* const from = out_gradient + channel * output_plane;
            kernels::resample_lanes_backward<T, down, along>(
                [&](std::size_t pixel) { return kernels::load(from + pixel * kernels::lanes<T>); },
                in_gradient + channel * input_plane);
        }
    }

private:
    using down = kernels::sampling_axis<mode, Input.rows, output.rows>;
    using along = kernels::sampling_axis<mode, Input.columns, output.columns>;
    static constexpr std::size_t input_plane = Input.area() * kernels::lanes<T>,
                                 output_plane = output.area() * kernels::lanes<T>;
};

} // namespace detail

template <extent2d Factor, interpolation Mode, class T, shape Input>
struct trained_layer<upsample<Factor, Mode>, T, Input>
    : detail::trained_resampling<upsample<Factor, Mode>, T, Input> {};
template <extent2d Size, interpolation Mode, class T, shape Input>
struct trained_layer<upsample_to<Size, Mode>, T, Input>
    : detail::trained_resampling<upsample_to<Size, Mode>, T, Input> {};

}} // namespace tactnet
