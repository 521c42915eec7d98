#pragma once

#include <string>
#include <string_view>

/// Text that may hold the name of a file, or what a file says of itself, fit for one line of a terminal:
/// control characters, those that turn the direction of writing and bytes that are not UTF-8 become \xNN. All
/// that the program prints of such text passes through here.
std::string printable(std::string_view text);
