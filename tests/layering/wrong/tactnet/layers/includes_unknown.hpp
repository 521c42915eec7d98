#pragma once

#include <tactnet/detail/config.hpp>
#include <tactnet/cellar/wine.hpp>
