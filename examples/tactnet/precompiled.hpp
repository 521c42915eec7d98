#pragma once

// What most of the program's networks and methods read of other libraries. Nothing of tactnet, so that a
// change of one of its headers compiles only what includes it.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <variant>
#include <vector>

#ifndef TACTNET_NO_SIMD
#include <xsimd/xsimd.hpp>
#endif
