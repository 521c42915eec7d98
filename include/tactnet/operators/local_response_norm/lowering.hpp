#pragma once

#include <tactnet/lowering/lowering.hpp>
#include <tactnet/operators/local_response_norm/layer.hpp>
#include <tactnet/operators/local_response_norm/step.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t Size, class Alpha, class Beta, class K>
struct lowering<local_response_norm<Size, Alpha, Beta, K>> {
    // Fractions in lowest terms, as above.
    using rule = kernels::response_rule<Size, typename Alpha::type, typename Beta::type, typename K::type>;
    template <class Place>
    using at = lowered_to<
        local_response_norm_step<typename Place::format, Place::layer::output, Place::input_stride, rule>>;
};

}} // namespace tactnet
