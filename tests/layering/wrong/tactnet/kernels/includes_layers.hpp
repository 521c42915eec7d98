#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/layers/dense.hpp>
