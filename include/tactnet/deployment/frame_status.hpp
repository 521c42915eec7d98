#pragma once

#include <tactnet/detail/config.hpp>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What became of a frame. Not to be ignored: outputs of a broken frame look like any others.
enum class [[nodiscard]] frame_status{
    ok,
    not_finite ///< NaN or infinity in the frame or in the outputs, or a number so large that sums in the
               ///< network might leave the range of single precision: the outputs mean nothing
};

} // namespace TACTNET_ARCH
} // namespace tactnet
