#pragma once

// All that the programs do, with what must be left behind.

#include "scene.hpp"

#include <string>
#include <vector>

namespace faults {

struct job {
    std::string name;
    words command;
    std::vector<std::string> brings; ///< of what was made
    std::string input;               ///< from the standard input
    bool prints;                     ///< results on the standard output, which must not be lost
    bool draws;                      ///< pictures
    std::string (*wrong)(const materials&, const fs::path& folder, bool done); ///< of what is left there
};

/// All of them, or those that leave files.
std::vector<job> jobs(const materials& made, bool only_writers = false);

/// Runs a job in a folder of the scene. Judges how it ended, and what it left under its final names.
/// `heard`: whether messages reach anyone.
finding attempt(scene& s, const job& what, conditions under, bool heard = true);

/// Why something that is left is not what an undisturbed program leaves; empty if all is well.
std::string wrong_among_reports(const fs::path& folder);

} // namespace faults
