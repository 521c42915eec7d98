#pragma once

#include <tactnet/detail/config.hpp>

#include <Eigen/Core>
