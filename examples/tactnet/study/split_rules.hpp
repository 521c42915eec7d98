#pragma once

// What a method owes to images that are nearly copies of each other.

#include "study/rows.hpp"

#include <string>
#include <vector>

/// Part of the page: random against blocked splits, the method first that loses least; nothing where no
/// method has both.
std::string split_rules_table(const std::vector<study_row>& rows);
