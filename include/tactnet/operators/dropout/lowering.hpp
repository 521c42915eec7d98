#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/dropout/layer.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

template <unsigned Percent>
struct lowering<dropout<Percent>> {
    static constexpr bool inference_no_op = true;
};

}} // namespace tactnet
