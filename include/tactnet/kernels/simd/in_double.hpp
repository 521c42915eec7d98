#pragma once

#include <tactnet/kernels/simd/vector.hpp>

// Numbers of either precision, computed in double and rounded once.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Loads floats or doubles as doubles.
[[nodiscard]] inline vector<double> load_double(const float* from) {
    return widen(from);
}
[[nodiscard]] inline vector<double> load_double(const double* from) {
    return load(from);
}
/// Rounds doubles to floats, or keeps them, and stores them.
inline void store_double(float* to, const vector<double>& values) {
    narrow(to, values);
}
inline void store_double(double* to, const vector<double>& values) {
    store(to, values);
}

}}} // namespace tactnet::kernels
