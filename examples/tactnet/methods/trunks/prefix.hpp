#pragma once

#include <string_view>

/// How the names of a trunk's arrays begin in the file of a method that is trained behind it.
inline constexpr std::string_view trunk_prefix = "trunk.";
