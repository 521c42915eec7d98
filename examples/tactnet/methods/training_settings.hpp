#pragma once

// What a user may choose about a training, and the recipe that follows from it.

#include "methods/method.hpp"

#include <tactnet/training/data/split.hpp>
#include <tactnet/training/recipe.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

struct training_settings {
    std::size_t rows = 28, columns = 50;
    bool resize = false;
    std::string recipe = "default";
    std::optional<std::size_t> epochs, batch;
    std::optional<double> rate;
    std::optional<std::string> input, augmentation;
    std::string start; ///< weight file to begin with; empty for random weights
    /// File of a network trained on photographs, for methods that begin with one; else empty.
    std::string pretrained;
    tactnet::split_shares shares;
    std::size_t bits = 32;   ///< of a weight, once it is trained: 8, or single precision
    std::size_t unknown = 0; ///< classes that one more training leaves out, as unknown objects
};

/// --rows, --columns, --resize, --recipe, all that changes a recipe and what a training begins with.
/// `pretrained`: the names of the option for a network trained on photographs.
void add_training_options(CLI::App& command, training_settings& settings,
                          const std::string& pretrained = "--pretrained");

/// --data, which is required.
void add_data_option(CLI::App& command, std::string& folder);
/// --bits.
void add_bits_option(CLI::App& command, std::size_t& bits, const std::string& what_for);
/// --unknown.
void add_unknown_option(CLI::App& command, std::size_t& unknown);

/// Throws usage_error for 8 bits unless the method has such a form.
void check_bits(const method& what, std::size_t bits);

/// "random" or "blocked".
tactnet::split_rule split_rule_of(std::string_view name);
std::string_view name_of(tactnet::split_rule rule);

/// What --recipe takes.
const std::vector<std::string>& recipe_names();
/// Whether it can be trained by the thorough recipe: a network that starts from random weights.
bool may_be_thorough(const method& what);

/// Whether some setting is one of a training by epochs, which support vector machines do not have.
bool is_for_networks(const training_settings& settings);
/// The same settings without those.
training_settings without_epochs(training_settings settings);

/// The recipe for a method, with the user's changes. Throws usage_error.
tactnet::recipe recipe_for(const method& what, const training_settings& settings);

/// The file of a pretrained network in the settings, opened; null for a method that needs none. Throws
/// usage_error where it is missing or of no use, and tactnet::file_error.
std::shared_ptr<pretrained_weights> open_pretrained(const method& what, const training_settings& settings);
