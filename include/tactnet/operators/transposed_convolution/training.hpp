#pragma once

#include <tactnet/operators/convolution/training.hpp>
#include <tactnet/operators/transposed_convolution/layer.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <class Spec, class T, shape Input, class Layer = typename Spec::template layer<T, Input>>
using transposed_conv2d_passes =
    convolution_passes<Spec, T, Input, true,
                       kernels::batch_convolution::backward(Layer::window, Input.channels),
                       kernels::batch_convolution::forward(Layer::window, Input.channels)>;

} // namespace detail

template <std::size_t Filters, extent2d Kernel, extent2d Stride, padding Padding, bool Bias, class T,
          shape Input>
struct trained_layer<transposed_conv2d<Filters, Kernel, Stride, Padding, Bias>, T, Input>
    : detail::transposed_conv2d_passes<transposed_conv2d<Filters, Kernel, Stride, Padding, Bias>, T, Input> {
    using base =
        detail::transposed_conv2d_passes<transposed_conv2d<Filters, Kernel, Stride, Padding, Bias>, T, Input>;
    using typename base::memory;

    static void prepare(const execution_context&, const T* values, const T*, memory& m) {
        m.forward_weights.resize(base::forward_method::packed_elements);
        const auto weight = [&](auto filter, auto channel, auto row, auto column) {
            return values[at(channel, filter, Kernel.rows - 1 - row, Kernel.columns - 1 - column)];
        };
        base::forward_method::pack(weight, m.forward_weights.data());
    }

    static void begin_backward(const execution_context&, const T* values, memory& m, std::size_t) {
        base::clear_totals(m);
        m.backward_weights.resize(base::input_gradient_method::packed_elements);
        const auto weight = [&](auto channel, auto filter, auto row, auto column) {
            return values[at(channel, filter, row, column)];
        };
        base::input_gradient_method::pack(weight, m.backward_weights.data());
    }

private:
    static constexpr std::size_t at(std::size_t channel, std::size_t filter, std::size_t row,
                                    std::size_t column) {
        return ((channel * Filters + filter) * Kernel.rows + row) * Kernel.columns + column;
    }
};

}} // namespace tactnet
