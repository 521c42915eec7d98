#pragma once

// What the layer becomes when a network is deployed.

#include "leaky_relu.hpp"
#include "leaky_relu_step.hpp"

#include <tactnet/deployment/lowering/lowering.hpp>

template <unsigned Percent>
struct tactnet::lowering<own::leaky_relu<Percent>> {
    template <class Place>
    using at = tactnet::lowered_to<
        own::leaky_relu_step<typename Place::format, Percent, Place::layer::output, Place::input_stride>>;
};
