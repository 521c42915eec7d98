#pragma once

// What decides the result of a training, as text. It goes into weight files, checkpoints and lists of
// results, and a stopped training goes on only where it is the same: so none of it may be left out.

#include "data/image_data.hpp"
#include "methods/training_settings.hpp"

/// All of a recipe. A field that a recipe gets anew does not compile until it is here.
tactnet::file_metadata describe_recipe(const tactnet::recipe& recipe);

/// Throws tactnet::file_error unless the metadata of a file say all of this.
void require_metadata(const tactnet::safetensors& file, const tactnet::file_metadata& expected);

/// Differs when any of it differs.
std::string fingerprint_of(const tactnet::file_metadata& settings);

/// Differs when any byte of the file differs. Computed once for each name while the program runs.
std::string pretrained_fingerprint(const std::string& path);

/// What decides how this program rounds: its version, and the instruction set that it was compiled for, as
/// the library names it, for example simd_avx2_fma. A name with sse2 or scalar shows a forgotten -march.
tactnet::file_metadata describe_program();
/// The name of an instruction set without the parts that cannot change a bit of a training: those of
/// integers.
std::string float_instruction_set(std::string name);

/// All that decides what comes of a training, apart from images, split and seed.
tactnet::file_metadata describe_method(const method& what, const tactnet::recipe& recipe);

/// Everything that decides the result of a training: two with the same description give the same bits.
tactnet::file_metadata describe_training(const method& what, const training_settings& settings,
                                         tactnet::split_rule rule, std::uint64_t seed,
                                         const image_data& data);

/// What also decides which short trainings there are for `auto`, and how they are judged: kinds that options
/// fix, if only at what the recipe has, and groups, whatever the split. Nothing if there are none.
tactnet::file_metadata describe_trials(const method& what, const training_settings& settings,
                                       const image_data& data);
