#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/deployment/steps/local_response_norm.hpp>
#include <tactnet/layers/local_response_norm.hpp>

#include <cstddef>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <std::size_t Size, class Alpha, class Beta, class K>
struct lowering<local_response_norm<Size, Alpha, Beta, K>> {
    /// Constants in lowest terms, so that equal ones are one step, and one spelling.
    using rule = kernels::response_rule<Size, typename Alpha::type, typename Beta::type, typename K::type>;
    template <class Place>
    using at = lowered_to<
        local_response_norm_step<typename Place::format, Place::layer::output, Place::input_stride, rule>>;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
