#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/last_frame/layer.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

/// In a stream the last frame is the present one.
template <>
struct lowering<last_frame> {
    static constexpr bool inference_no_op = true;
};

}} // namespace tactnet
