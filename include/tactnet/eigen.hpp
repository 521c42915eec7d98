#pragma once

#include <tactnet/eigen/elements.hpp>
#include <tactnet/eigen/frames.hpp>

// Eigen matrices without a copy: `view_…` views a matrix as a type of this library, `map_…` maps data of this
// library as an Eigen::Map. Sizes are compared when compiling if the types determine them, otherwise at run
// time. Needs Eigen 3.4 or newer (tested with 3.4 and 5.0) and the CMake target tactnet::eigen.
