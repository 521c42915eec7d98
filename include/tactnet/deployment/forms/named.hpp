#pragma once

#include <tactnet/deployment/forms/form.hpp>
#include <tactnet/layers/composition/named.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// That of what is named.
template <name_text Name, class Spec>
struct deployed_form<named<Name, Spec>> : deployed_form<Spec> {};

} // namespace TACTNET_ARCH
} // namespace tactnet
