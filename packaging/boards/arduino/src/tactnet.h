#pragma once

// By this file the build finds the library: sketches include it first, then what they need.
#include <tactnet/version.hpp>
