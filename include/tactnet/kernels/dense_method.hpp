#pragma once

#include <tactnet/kernels/frame/dense.hpp>
#include <tactnet/kernels/method_list.hpp>
#include <tactnet/kernels/panels/large_convolution.hpp>

#include <cstddef>

// The method that computes a dense layer of one frame or a few.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// Many weights, by panels: a convolution with a kernel as large as the map.
template <frame_dense D>
struct panel_dense_method
    : panel_method<frame_convolution{.window = {D.input, {D.input.rows, D.input.columns}, 1},
                                     .filters = D.outputs,
                                     .input_stride = D.input_stride}> {
    static constexpr frame_convolution convolution{.window = {D.input, {D.input.rows, D.input.columns}, 1},
                                                   .filters = D.outputs,
                                                   .input_stride = D.input_stride};
    static constexpr bool applicable = D.exceeds_near_caches() && large_convolution::fits(convolution);
    static constexpr std::size_t output_stride = convolution.output_stride();

    template <class Weight>
    static constexpr void pack(const Weight& weight, const float* biases, float* to) {
        panel_method<convolution>::pack(
            [&](std::size_t o, std::size_t channel, std::size_t row, std::size_t column) {
                return weight(o, channel, row * D.input.columns + column);
            },
            biases, to);
    }
};

/// The chosen method.
template <frame_dense D>
using dense_method = typename method_list<direct_dense_method<D>, panel_dense_method<D>>::cheapest;

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
