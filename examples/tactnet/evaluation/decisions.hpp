#pragma once

// What a controller makes of a method's outputs, measured on the images of a split: sets of possible classes,
// faults of the sensor, unknown objects.

#include "data/image_data.hpp"
#include "methods/method.hpp"

#include <tactnet/training/data/split.hpp>
#include <tactnet/training/evaluate.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>

/// A mean, as what it is made of, so that the images of several splits count together.
struct decision_mean {
    double sum = 0, count = 0;
    double value() const { return sum / count; }
};
/// By the names of decision_columns; without those that were not measured.
using decision_means = std::map<std::string, decision_mean>;

struct decision_column {
    std::string_view name, title;
    bool is_share = true; ///< printed in percent
};
inline constexpr std::array decision_columns{
    decision_column{"set_coverage", "right class in the set, %"},
    decision_column{"set_size", "classes in a set", false},
    decision_column{"stuck_row_accuracy", "a row stuck, %"},
    decision_column{"stuck_row_corrected_accuracy", "a row stuck, corrected, %"},
    decision_column{"stuck_tactels_accuracy", "5 % stuck, %"},
    decision_column{"stuck_tactels_corrected_accuracy", "5 % stuck, corrected, %"},
    decision_column{"unknown_softmax_area", "unknown by softmax: area, %"},
    decision_column{"unknown_softmax_accepted", "unknown by softmax: accepted, %"},
    decision_column{"unknown_energy_area", "unknown by energy: area, %"},
    decision_column{"unknown_energy_accepted", "unknown by energy: accepted, %"},
};
/// What the columns are, in sentences.
inline constexpr std::string_view decision_caption =
    "Sets of possible classes hold the right one in 95 % of images, by a threshold from the validation "
    "images. Accuracy with a fault of the sensor, alone and corrected by sensor_health; faults begin after "
    "it has learnt frames of air. Unknown: with some classes left out of the training, the area under the "
    "receiver operating characteristic, and how many images of these are accepted where 95 % of the "
    "others are.";

/// A mean in percent, or as it is. Empty if it was not measured.
std::string text_of(const decision_means& means, const decision_column& column);

void add_means(decision_means& to, const decision_means& from);

/// By the validation images of a split. Nothing for methods without logits, or without such images.
decision_means sets_of_classes(const tactnet::evaluation& validation, const tactnet::evaluation& test,
                               const image_data& data, const tactnet::data_split& split);

/// Nothing at other sizes than the paper's, since those of sensor_health are fixed when compiling.
decision_means faults_of_sensor(const trained_method& trained, const image_data& data,
                                std::span<const std::size_t> images, std::uint64_t seed,
                                tactnet::thread_pool& threads);

/// The images of some classes.
image_data images_of_classes(const image_data& all, std::span<const std::size_t> classes);
/// Leaves out as many classes; each comes as often over the seeds.
struct class_choice {
    std::vector<std::size_t> known, unknown;
};
class_choice choose_classes(std::size_t classes, std::size_t unknown, std::uint64_t seed);

/// How well scores of a method that was trained on the known classes separate the images of others.
decision_means separation(const tactnet::evaluation& of_known, const tactnet::evaluation& of_unknown,
                          std::size_t classes);
