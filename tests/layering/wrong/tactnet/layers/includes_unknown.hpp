#pragma once

#include <tactnet/cellar/wine.hpp>
#include <tactnet/detail/config.hpp>
