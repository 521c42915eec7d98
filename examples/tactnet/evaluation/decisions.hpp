#pragma once

// What a controller makes of a network's outputs, measured on the images of a split: sets of possible
// classes, faults of the sensor.

#include "data/image_data.hpp"
#include "methods/method.hpp"

#include <map>

/// Sums and counts by the names of decision_columns, so that the images of several splits count together;
/// without those that were not measured.
using decision_means = std::map<std::string, std::array<double, 2>>;

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
};

/// Sets of classes on the test images, by the validation images, to which `scaling` was fitted.
decision_means sets_of_classes(const tactnet::temperature_scaling& scaling,
                               const tactnet::evaluation& validation, const tactnet::evaluation& test,
                               const image_data& data, const tactnet::data_split& split);

/// Accuracy on images of a sensor with stuck tactels, alone and corrected. Nothing at other sizes than the
/// paper's, since those of sensor_health are fixed when compiling.
decision_means faults_of_sensor(const trained_method& trained, const image_data& data,
                                std::span<const std::size_t> images, std::uint64_t seed,
                                tactnet::thread_pool& threads);
