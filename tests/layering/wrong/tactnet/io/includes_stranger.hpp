#pragma once

#include <tactnet/detail/config.hpp>

#include <fmt/core.h>
