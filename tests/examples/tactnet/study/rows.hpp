#pragma once

// Rows of a made-up study.

#include <cstddef>
#include <string>
#include <string_view>
#include <study/rows.hpp>
#include <vector>

namespace support {

inline bool has(const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
}

/// A method with 20 random splits, timed.
inline study_row studied(const std::string& method, double accuracy, double microseconds,
                         const std::string& recipe = "default") {
    study_row row{.method = method, .rows = 7, .columns = 13, .recipe = recipe};
    row.accuracies.push_back({tactnet::split_rule::random, 20, 20, {accuracy, 0.01}, 0.99, 1});
    row.latency = frame_latency{microseconds, 2 * microseconds, microseconds / 2, 1.5};
    return row;
}

/// A method that was not run.
inline study_row not_run(const std::string& method, const std::string& why) {
    study_row row{.method = method, .rows = 28, .columns = 50, .recipe = "default"};
    row.missing = why;
    return row;
}

} // namespace support
