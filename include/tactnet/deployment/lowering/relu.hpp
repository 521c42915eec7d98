#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/deployment/steps/relu.hpp>
#include <tactnet/layers/relu.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <>
struct lowering<relu> {
    static constexpr bool rectifies = true;
    template <class Place>
    using at = lowered_to<relu_step<typename Place::format, Place::layer::output, Place::input_stride>>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
