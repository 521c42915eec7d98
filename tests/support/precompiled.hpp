#pragma once

// What most tests read of other libraries. Nothing of tactnet, so that a change of one of its headers
// compiles only the tests that include it.

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <thread>
#include <variant>
#include <vector>

#ifndef TACTNET_NO_SIMD
#include <xsimd/xsimd.hpp>
#endif
