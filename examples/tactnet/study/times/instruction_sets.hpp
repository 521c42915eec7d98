#pragma once

// What a method costs on processors that have less than this one: programs compiled for other instruction
// sets, timed on the same core.

#include "study/rows.hpp"

#include <string>
#include <string_view>
#include <vector>

/// "AVX-512" for a name such as simd_avx512f_fma_bmi2 (tactnet/detail/instruction_set.hpp).
std::string instruction_set_title(std::string_view name);

/// Part of the page: microseconds a frame by instruction set, the widest first; nothing where only one was
/// timed.
std::string instruction_sets_table(const std::vector<study_row>& rows);
