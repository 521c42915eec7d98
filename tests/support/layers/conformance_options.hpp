#pragma once

namespace support {

/// How a layer is checked (conformance.hpp).
struct conformance_options {
    double low = -2, high = 2; ///< range of the inputs
    double epsilon = 1e-5;
    /// Random in training: the reference then says nothing of training.
    bool random = false;
};

} // namespace support
