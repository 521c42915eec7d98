#pragma once

#include <tactnet/tensor/shape.hpp>

#include <support/layers/reference.hpp>

namespace support {

/// The reference's form of a resolved window.
inline reference_window window_of(const tactnet::sliding_window& w) {
    return {{w.input.channels, w.input.rows, w.input.columns},
            w.kernel.rows,
            w.kernel.columns,
            w.stride.rows,
            w.stride.columns,
            w.top,
            w.bottom,
            w.left,
            w.right};
}

} // namespace support
