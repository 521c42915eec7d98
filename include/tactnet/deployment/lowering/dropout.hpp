#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/layers/dropout.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <unsigned Percent>
struct lowering<dropout<Percent>> {
    static constexpr bool inference_no_op = true;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
