#pragma once

#include <tactnet/deployment/lowering/lowering.hpp>
#include <tactnet/layers/composition/named.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// That of what is named.
template <name_text Name, class Spec>
struct lowering<named<Name, Spec>> : lowering<Spec> {};

} // namespace TACTNET_ARCH
} // namespace tactnet
