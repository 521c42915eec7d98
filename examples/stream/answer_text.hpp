#pragma once

// Answers as text: a line for people, a line of JSON for programs, a picture for a terminal.

#include "answer.hpp"

#include <tactnet/text/message.hpp>
#include <tactnet/text/numbers.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <utility>
#include <vector>

inline std::string formatted(const char* format, double value) {
    std::array<char, 64> text;
    std::snprintf(text.data(), text.size(), format, value);
    return text.data();
}

/// Number, label, probability and microseconds, with tabs between them; where air was learnt, area and the
/// number of faulty tactels stand before the microseconds. In air the label is "-".
inline std::string line_of(const answer& a, const std::vector<std::string>& classes) {
    std::string line = std::to_string(a.number) + '\t' + (a.found ? classes[a.found->index] : "-") + '\t' +
                       formatted("%.4f", a.found ? a.found->probability : 0);
    if (a.contact)
        line += '\t' + std::to_string(a.contact->area) + '\t' + std::to_string(a.faults.size());
    return line + '\t' + formatted("%.1f", a.microseconds) + '\n';
}

/// The same as an object, without what is not known.
inline std::string json_line_of(const answer& a, const std::vector<std::string>& classes) {
    std::string line = "{\"frame\":" + std::to_string(a.number);
    if (a.seconds)
        line += ",\"seconds\":" + tactnet::shortest_number(*a.seconds);
    if (a.contact)
        line += std::string(",\"touching\":") + (a.contact->touching ? "true" : "false") +
                ",\"area\":" + std::to_string(a.contact->area) +
                ",\"force\":" + std::to_string(a.contact->force);
    if (a.found)
        line += ",\"label\":" + tactnet::json_string(classes[a.found->index]) +
                ",\"probability\":" + formatted("%.4f", a.found->probability);
    if (a.contact) {
        line += ",\"faults\":[";
        for (const tactnet::tactel_fault& fault : a.faults)
            line += std::string(&fault == a.faults.data() ? "" : ",") +
                    "{\"row\":" + std::to_string(fault.row) + ",\"column\":" + std::to_string(fault.column) +
                    ",\"kind\":\"" + std::string(name_of(fault.kind)) +
                    "\",\"since\":" + std::to_string(fault.since) + '}';
        line += ']';
    }
    return line + ",\"microseconds\":" + formatted("%.1f", a.microseconds) + "}\n";
}

/// A colour whose lightness grows with the count: corners of matplotlib's "inferno" map (van der Walt and
/// Smith, 2015), with lines between them. The largest count of a frame is the lightest.
inline std::array<int, 3> colour_of(double count, double largest) {
    constexpr std::array<std::array<double, 3>, 6> corners{
        {{0, 0, 4}, {66, 10, 104}, {147, 38, 103}, {221, 81, 58}, {252, 165, 10}, {252, 255, 164}}};
    const double place = std::max(count, 0.0) / std::max(largest, 32.0) * (corners.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(place), corners.size() - 2);
    std::array<int, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c)
        colour[c] = static_cast<int>(
            std::lround(corners[below][c] +
                        (place - static_cast<double>(below)) * (corners[below + 1][c] - corners[below][c])));
    return colour;
}

/// Two rows of tactels in a row of characters, by half blocks; faulty tactels are blue. Written over the
/// picture before.
inline std::string picture_of(const answer& a, const std::vector<std::string>& classes) {
    constexpr std::array<int, 3> faulty{60, 130, 255};
    const std::size_t columns = a.columns, rows = a.counts.size() / columns;
    std::vector<std::array<int, 3>> colours(rows * columns);
    const float largest = *std::ranges::max_element(a.counts);
    for (std::size_t i = 0; i < a.counts.size(); ++i)
        colours[i] = colour_of(a.counts[i], largest);
    for (const tactnet::tactel_fault& fault : a.faults)
        colours[fault.row * columns + fault.column] = faulty;
    std::string text = "\x1b[H"; // the upper left corner
    // Many neighbours have the same colour.
    std::array<std::string, 2> grounds;
    const auto add = [&](bool behind, const std::array<int, 3>& colour) {
        const std::string code = std::string("\x1b[") + (behind ? "48" : "38") + ";2;" +
                                 std::to_string(colour[0]) + ';' + std::to_string(colour[1]) + ';' +
                                 std::to_string(colour[2]) + 'm';
        if (std::exchange(grounds[behind], code) != code)
            text += code;
    };
    for (std::size_t row = 0; row < rows; row += 2) {
        for (std::size_t column = 0; column < columns; ++column) {
            add(false, colours[row * columns + column]);
            if (row + 1 < rows)
                add(true, colours[(row + 1) * columns + column]);
            text += "▀";
        }
        text += "\x1b[0m\x1b[K\n";
        grounds = {};
    }
    text += "frame " + std::to_string(a.number) + "  ";
    text += a.found ? classes[a.found->index] + formatted(" %.1f %%", 100 * a.found->probability)
                    : "nothing touches";
    if (a.contact)
        text += "  area " + std::to_string(a.contact->area) + "  faulty " + std::to_string(a.faults.size());
    return text + formatted("  %.1f us", a.microseconds) + "\x1b[K\n\x1b[J";
}
