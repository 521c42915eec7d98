#pragma once

#include <tactnet/kernels/batch/resampling.hpp>
#include <tactnet/operators/trained_layer.hpp>
#include <tactnet/operators/upsampling/layer.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

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
