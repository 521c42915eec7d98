#pragma once

#include <string>
#include <string_view>

/// For the text of HTML and for attributes in double quotes.
std::string escaped(std::string_view text);
