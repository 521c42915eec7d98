#pragma once

#include <tactnet/eigen/elements.hpp>
#include <tactnet/eigen/features.hpp>
#include <tactnet/eigen/frames.hpp>
#include <tactnet/eigen/parameters.hpp>

// To and from Eigen's matrices without a copy: `view_…` makes of a matrix what this library takes, `map_…`
// makes of what this library holds an Eigen::Map. Sizes known when compiling are compared when compiling,
// others when called. Needs Eigen 3.4 or newer (tested with 3.4 and 5.0): CMake's tactnet::eigen.

#include <tactnet/eigen/sensor_frames.hpp>
