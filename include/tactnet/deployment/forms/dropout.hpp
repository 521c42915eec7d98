#pragma once

#include <tactnet/deployment/forms/form.hpp>
#include <tactnet/layers/dropout.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

template <unsigned Percent>
struct deployed_form<dropout<Percent>> {
    static constexpr bool passes_on = true;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
