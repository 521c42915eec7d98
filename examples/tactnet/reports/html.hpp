#pragma once

#include <string>
#include <string_view>

/// For the text of HTML and for attributes in double quotes.
std::string escaped(std::string_view text);

/// Where an axis of percents begins so that `lowest` is on it: 85 for 87.3.
double axis_below(double lowest);

/// A cell of a table with a bar between two values, in percent, of an axis from `axis` to 100. The page has
/// the style of the class "bar".
std::string bar_cell(double one, double other, double axis);
