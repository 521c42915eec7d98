#pragma once

#include <tactnet/operators/local_response_norm/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t Size, class Alpha, class Beta, class K, class T, shape Input>
struct trained_layer<local_response_norm<Size, Alpha, Beta, K>, T, Input>
    : lane_block_layer<local_response_norm<Size, Alpha, Beta, K>, T, Input> {
    using rule = typename local_response_norm<Size, Alpha, Beta, K>::rule;

    static void forward_block(const T* in, T* out) {
        kernels::normalise_responses<rule>(Input.channels, Input.area(), in, out);
    }
    static void backward_block(const T* in, const T*, const T* out_gradient, T* in_gradient) {
        kernels::normalise_responses_backward<rule>(Input.channels, Input.area(), in, out_gradient,
                                                    in_gradient);
    }
};

}} // namespace tactnet
