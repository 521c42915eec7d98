#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/image/resize.hpp>
