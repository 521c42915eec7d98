#pragma once

#include <string>
#include <string_view>
#include <vector>

/// The name that was most likely meant: one that differs by two slips at most (a letter too many, too few,
/// another one, two exchanged), and by less than half of it. Nothing if there is none.
std::string closest_name(std::string_view typed, const std::vector<std::string>& names);
