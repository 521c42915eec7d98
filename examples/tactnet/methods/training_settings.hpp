#pragma once

// What a user may choose about a training, and the recipe that follows from it.

#include "data/image_data.hpp"
#include "methods/method.hpp"

namespace CLI {
class App;
}

/// Settings of a training by epochs, which support vector machines do not have.
struct epoch_settings {
    std::optional<std::size_t> epochs, batch;
    std::optional<double> rate, rotation, translation, scale, gain, noise, erase, knee;
    std::optional<std::string> input, function, augmentation, reflect;
    std::vector<std::string> partners; ///< "left=right": classes that reflections of columns exchange
    std::string start;                 ///< weight file to begin with; empty for random weights

    bool operator==(const epoch_settings&) const = default;
};

struct training_settings : epoch_settings {
    std::size_t rows = 28, columns = 50;
    image_reading images;
    std::string recipe = "default";
    /// File of a network trained on photographs, for methods that begin with one; else empty.
    std::string pretrained;
    tactnet::split_shares shares;
    std::size_t folds = 5; ///< of rules with a number of them
    bool balance = false;  ///< rare classes are repeated in training
    double share = 1;      ///< of the training images that are used, for a curve of accuracy
    std::size_t bits = 32; ///< of a weight, once it is trained: 8, or single precision

    /// Whether the training images choose the augmentation: by their mean images, and by short trainings.
    bool chooses(const method& what) const {
        return what.begins_at_random() && recipe != "published" && augmentation.value_or("auto") == "auto";
    }
    bool tries(const method& what) const { return chooses(what) && (augmentation || recipe == "default"); }
};

/// --rows, --columns, --resize, --sensor, --recipe, all that changes a recipe and what a training begins
/// with. `pretrained`: the names of the option for a network trained on photographs.
void add_training_options(CLI::App& command, training_settings& settings,
                          const std::string& pretrained = "--pretrained");

/// --resize and --sensor.
void add_image_options(CLI::App& command, image_reading& images);
void add_sensor_option(CLI::App& command, std::string& sensor);
/// --data, which is required.
void add_data_option(CLI::App& command, std::string& folder);
/// --bits.
void add_bits_option(CLI::App& command, std::size_t& bits, const std::string& what_for);

/// Throws usage_error for 8 bits unless the method has such a form.
void check_bits(const method& what, std::size_t bits);

/// What --split takes, such as "random" and "leave-one-group-out".
inline constexpr std::array<std::pair<std::string_view, tactnet::split_rule>, 7> split_rule_names{{
    {"random", tactnet::split_rule::random},
    {"blocked", tactnet::split_rule::blocked},
    {"grouped", tactnet::split_rule::grouped},
    {"group-folds", tactnet::split_rule::group_folds},
    {"leave-one-group-out", tactnet::split_rule::leave_one_group_out},
    {"stratified-folds", tactnet::split_rule::stratified_folds},
    {"given", tactnet::split_rule::given},
}};
std::string_view name_of(tactnet::split_rule rule);
/// The rule of that name; without a name what the data ask for: the split of a table, whole groups where
/// there are groups, or else `usual`. Throws usage_error for a name that is none, and for data without what
/// the rule needs.
tactnet::split_rule split_rule_for(std::string_view name, const image_data& data,
                                   tactnet::split_rule usual = tactnet::split_rule::random);
/// --split, which also takes `more`.
void add_split_option(CLI::App& command, std::string& name, std::string_view usual,
                      std::string_view more = "");

/// How many splits a rule has, in all; nothing where any seed gives another one.
std::optional<std::size_t> splits_of(tactnet::split_rule rule, const image_data& data, std::size_t folds);

/// The split of a training. Throws usage_error for parts that have images or groups in common, and for
/// classes that training lacks.
tactnet::data_split split_for(const image_data& data, const training_settings& settings,
                              tactnet::split_rule rule, std::uint64_t seed);

/// What --recipe takes.
inline const std::vector<std::string> recipe_names{"default", "thorough", "published"};

/// The recipe for a method, with the user's changes. Epochs that are not set suit that many training
/// images, if the number is known and the recipe is not the published one. Throws usage_error.
tactnet::recipe recipe_for(const method& what, const training_settings& settings,
                           std::size_t training_images = 0);

/// The recipe for a training on these images of a folder, with what they choose, and why. Short trainings
/// whose scores are `known` are not repeated, and those of others are added. Throws usage_error.
tactnet::augmentation_choice choose_recipe(const method& what, const training_settings& settings,
                                           const image_data& data, std::span<const std::size_t> training,
                                           std::uint64_t seed, tactnet::thread_pool& threads,
                                           const tactnet::search_stop& stop,
                                           tactnet::trial_scores* known = nullptr);
/// What options say, which images then do not choose.
tactnet::fixed_augmentation fixed_kinds(const training_settings& settings);
/// The settings of a checkpoint, with the scores of the short trainings that chose.
tactnet::file_metadata with_trials(tactnet::file_metadata settings, const tactnet::trial_scores& scores);
/// The scores in a checkpoint; none in one without. Throws tactnet::file_error.
tactnet::trial_scores trials_in(const tactnet::safetensors_index& checkpoint);

/// The pretrained file in the settings, opened; null for a method that needs none. Throws usage_error where
/// it is missing or of no use, and tactnet::file_error.
std::shared_ptr<pretrained_weights> open_pretrained(const method& what, const training_settings& settings);
