#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/kernels/batch/pooling.hpp>
