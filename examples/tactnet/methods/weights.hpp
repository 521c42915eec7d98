#pragma once

// A weight file, and what the user says about it where it does not do so itself.

#include "data/image_data.hpp"
#include "methods/training_settings.hpp"

namespace CLI {
class App;
}

struct weight_options {
    std::string weights, method, classes;
    std::optional<std::size_t> rows, columns;
    std::optional<double> epsilon;
    image_reading images;
};

struct loaded_weights {
    const method* what;
    std::unique_ptr<trained_method> trained;
    std::vector<std::string> classes;
    bool named; ///< whether anyone said what the classes are called
    tactnet::file_metadata metadata;
};

void add_weight_options(CLI::App& command, weight_options& options, bool required = true);

/// Throws tactnet::file_error and usage_error.
loaded_weights load_weights(const weight_options& options);

/// What a training of these classes begins with, or nothing. Throws tactnet::file_error and usage_error, also
/// for weights of other classes or inputs.
std::shared_ptr<const trained_method> load_start(const method& what, const training_settings& settings,
                                                 const std::vector<std::string>& classes);
void start(training_run& training, const trained_method* from);

/// A trained network in 8 bits, with ranges from the chosen images; for methods with such a form
/// (check_bits). Throws usage_error for weights that cannot be deployed so.
std::unique_ptr<trained_network> in_eight_bits(const trained_method& trained,
                                               const tactnet::labelled_images& images,
                                               std::span<const std::size_t> chosen);

/// The split of its training, as a weight file says. Throws usage_error for a file that no training has
/// written, and for other images than those of the training.
tactnet::data_split stored_split(const std::string& file, const tactnet::file_metadata& metadata,
                                 const std::string& folder, const image_data& data);
