#pragma once

#include <tactnet/operators/convolution/reference.hpp>
#include <tactnet/operators/sample_norms/reference.hpp>

// The steps in single precision, for calibration, of every operator for which that takes more than a few
// lines.
