#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/square_root/layer.hpp>
#include <tactnet/operators/square_root/step.hpp>

namespace tactnet { inline namespace TACTNET_ARCH {

template <class Offset>
struct lowering<square_root<Offset>> {
    // A fraction in lowest terms, so that equal ones are one step with one spelling.
    template <class Place>
    using at = lowered_to<square_root_step<typename Place::format, Place::layer::output, Place::input_stride,
                                           typename Offset::type>>;
};

}} // namespace tactnet
