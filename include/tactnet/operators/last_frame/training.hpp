#pragma once

#include <tactnet/operators/last_frame/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <algorithm>

namespace tactnet { inline namespace TACTNET_ARCH {

template <class T, shape Input>
struct trained_layer<last_frame, T, Input> : lane_block_layer<last_frame, T, Input> {
    static void forward_block(const T* in, T* out) { detail::read_frame<Input>(in, Input.rows - 1, out); }
    static void backward_block(const T*, const T*, const T* out_gradient, T* in_gradient) {
        std::fill_n(in_gradient, Input.size() * kernels::lanes<T>, T{});
        detail::write_frame<Input>(out_gradient, Input.rows - 1, in_gradient);
    }
};

}} // namespace tactnet
