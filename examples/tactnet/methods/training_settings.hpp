#pragma once

// What a user may choose about a training, and the recipe that follows from it.

#include "methods/method.hpp"

namespace CLI {
class App;
}

/// Settings of a training by epochs, which support vector machines do not have.
struct epoch_settings {
    std::optional<std::size_t> epochs, batch;
    std::optional<double> rate, rotation, translation;
    std::optional<std::string> input, augmentation;
    std::string start; ///< weight file to begin with; empty for random weights

    bool operator==(const epoch_settings&) const = default;
};

struct training_settings : epoch_settings {
    std::size_t rows = 28, columns = 50;
    bool resize = false;
    std::string recipe = "default";
    /// File of a network trained on photographs, for methods that begin with one; else empty.
    std::string pretrained;
    tactnet::split_shares shares;
    std::size_t bits = 32; ///< of a weight, once it is trained: 8, or single precision
};

/// --rows, --columns, --resize, --recipe, all that changes a recipe and what a training begins with.
/// `pretrained`: the names of the option for a network trained on photographs.
void add_training_options(CLI::App& command, training_settings& settings,
                          const std::string& pretrained = "--pretrained");

/// --data, which is required.
void add_data_option(CLI::App& command, std::string& folder);
/// --bits.
void add_bits_option(CLI::App& command, std::size_t& bits, const std::string& what_for);

/// Throws usage_error for 8 bits unless the method has such a form.
void check_bits(const method& what, std::size_t bits);

/// "random" or "blocked".
tactnet::split_rule split_rule_of(std::string_view name);
std::string_view name_of(tactnet::split_rule rule);

/// What --recipe takes.
inline const std::vector<std::string> recipe_names{"default", "thorough", "published"};

/// The recipe for a method, with the user's changes. Throws usage_error.
tactnet::recipe recipe_for(const method& what, const training_settings& settings);

/// The pretrained file in the settings, opened; null for a method that needs none. Throws usage_error where
/// it is missing or of no use, and tactnet::file_error.
std::shared_ptr<pretrained_weights> open_pretrained(const method& what, const training_settings& settings);
