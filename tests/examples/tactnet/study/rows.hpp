#pragma once

// Rows of a made-up study.

#include <string>
#include <study/rows.hpp>

namespace support {

/// A method with 20 random splits, timed.
inline study_row studied(const std::string& method, double accuracy, double microseconds,
                         const std::string& recipe = "default") {
    study_row row = make_row(method, 7, 13, recipe, 32);
    row.family = "touches";
    for (const auto& [name, value] : {std::pair{"random_splits", 20.0},
                                      {"random_splits_wanted", 20},
                                      {"random_accuracy", accuracy},
                                      {"random_deviation", 0.01},
                                      {"random_validation_accuracy", 0.99},
                                      {"microseconds", microseconds}})
        row.values[name] = value;
    return row;
}

} // namespace support
