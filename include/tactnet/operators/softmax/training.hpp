#pragma once

#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/operators/softmax/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <array>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <class T, shape Input>
struct trained_layer<softmax, T, Input> : lane_block_layer<softmax, T, Input> {
    // Also computes lanes without a sample, which the neighbouring layers read.
    static constexpr std::size_t plane = Input.area() * kernels::lanes<T>;

    static void forward_block(const T* in, T* out) {
        for (std::size_t i = 0; i < plane; ++i) {
            std::array<T, Input.channels> x;
            for (std::size_t c = 0; c < Input.channels; ++c)
                x[c] = in[i + c * plane];
            kernels::softmax_of<T>(x, x);
            for (std::size_t c = 0; c < Input.channels; ++c)
                out[i + c * plane] = x[c];
        }
    }
    static void backward_block(const T*, const T* out, const T* out_gradient, T* in_gradient) {
        for (std::size_t i = 0; i < plane; ++i) {
            const T *y = out + i, *dy = out_gradient + i;
            double product = 0;
            for (std::size_t c = 0; c < Input.channels; ++c)
                product += static_cast<double>(y[c * plane]) * static_cast<double>(dy[c * plane]);
            for (std::size_t c = 0; c < Input.channels; ++c)
                in_gradient[i + c * plane] = static_cast<T>(static_cast<double>(y[c * plane]) *
                                                            (static_cast<double>(dy[c * plane]) - product));
        }
    }
};

}} // namespace tactnet
