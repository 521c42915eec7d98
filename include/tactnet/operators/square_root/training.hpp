#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/operators/square_root/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <class Offset, class T, shape Input>
struct trained_layer<square_root<Offset>, T, Input> : lane_block_layer<square_root<Offset>, T, Input> {
    static constexpr T offset = static_cast<T>(square_root<Offset>::offset);
    static constexpr std::size_t elements = Input.size() * kernels::lanes<T>;

    static void forward_block(const T* in, T* out) {
        kernels::transform_vectors(kernels::shifted_root(offset), elements, out, in);
    }
    static void backward_block(const T*, const T* out, const T* out_gradient, T* in_gradient) {
        kernels::shifted_root_backward(offset, out, out_gradient, in_gradient, elements);
    }
};

}} // namespace tactnet
