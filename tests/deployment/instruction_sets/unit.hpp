#pragma once

#include <cstdint>
#include <vector>

// Deployed networks in a unit of its own, that is compiled for several instruction sets, each with a function
// of another name. Programs say what each unit found; alone or linked together, it must be the same.

struct reduced_result {
    std::vector<std::uint32_t> bits;       ///< of all outputs
    double of_bound = 0, of_deviation = 0; ///< largest errors
    std::vector<std::uint32_t> whole;      ///< bits of all outputs of networks in 8 bits
    bool as_reference = true;              ///< whether those are what plain loops give
    bool same_together = true;             ///< whether frames that pass together have the bits of each alone
    const char* instruction_set = "";
};

reduced_result reduced_first();
reduced_result reduced_second();
reduced_result reduced_third();
