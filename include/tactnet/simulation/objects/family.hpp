#pragma once

#include <tactnet/simulation/objects/drawing.hpp>

#include <string_view>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace simulation {

/// A kind of object: each draw is another one of its kind, in another pose, pressed with another force.
struct object_family {
    std::string_view name;
    touch (*draw)(drawing&); ///< one of them, by chance
};

} // namespace simulation
} // namespace TACTNET_ARCH
} // namespace tactnet
