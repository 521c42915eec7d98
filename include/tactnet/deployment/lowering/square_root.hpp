#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/deployment/steps/square_root.hpp>
#include <tactnet/layers/square_root.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <class Offset>
struct lowering<square_root<Offset>> {
    /// The offset in lowest terms, so that equal ones are one step, and one spelling.
    template <class Place>
    using at = lowered_to<square_root_step<typename Place::format, Place::layer::output, Place::input_stride,
                                           typename Offset::type>>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
