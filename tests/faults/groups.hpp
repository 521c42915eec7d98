#pragma once

// All that the programs do, with what must be left behind; and the groups of the attack. A group's cases are
// numbered from 0; any number is a case.

#include "scene.hpp"

#include <functional>
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
    std::function<std::string(const materials&, const fs::path& folder, bool done)>
        wrong; ///< of what is left
};

/// All of them, or those that leave files.
std::vector<job> jobs(const materials& made, bool only_writers = false);

/// Runs a job in a folder of the scene. Judges how it ended, and what it left under its final names.
/// `heard`: whether messages reach anyone.
void attempt(scene& s, const job& what, conditions under, bool heard = true);

/// Throws a finding if something that is left is not what an undisturbed program leaves. `when`: for people.
void expect_right(const scene& s, const job& what, bool done, const std::string& when);

/// Its cases throw a finding unless the programs handle them.
struct group {
    std::string name;
    /// Of how many cases this is one when all groups share a number of cases.
    std::size_t share;
    void (*attempt)(scene&, std::size_t number);
    /// Why there can be no such cases here; empty if there can.
    std::string (*missing)(const programs&);
};

/// With one bit flipped.
std::string damaged_by_bit(scene& s, std::string bytes);
/// Throws a finding unless the command fails, with a short message that has this part.
void expect_refusal(scene& s, const words& command, const std::string& part, const std::string& what);

void flip_bits(scene& s, std::size_t number);
void flip_bits_of_recordings(scene& s, std::size_t number);
void flip_two_bits_of_sums(scene& s, std::size_t number);
void replace_values(scene& s, std::size_t number);
void cut_files(scene& s, std::size_t number);
void kill_and_resume(scene& s, std::size_t number);
void fill_the_disk(scene& s, std::size_t number);
void limit_files(scene& s, std::size_t number);
void break_streams(scene& s, std::size_t number);
void take_resources(scene& s, std::size_t number);
void set_the_clock(scene& s, std::size_t number);
void ask_for_nonsense(scene& s, std::size_t number);
void name_strange_files(scene& s, std::size_t number);
void say_hostile_things(scene& s, std::size_t number);
void spoil_tables(scene& s, std::size_t number);
void spoil_archives(scene& s, std::size_t number);
void spoil_descriptions(scene& s, std::size_t number);

/// Mounts a small disk for `fill_the_disk`, away from everyone else; why not, if not.
std::string small_disk(const programs& which);
/// Why no program can be given a clock for `set_the_clock`; empty if it can.
std::string clock_library(const programs& which);

} // namespace faults
