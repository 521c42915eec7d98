#pragma once

#include <string>
#include <string_view>

enum class picture_format { png, svg };

/// What gnuplot made of a script.
struct drawn_picture {
    std::string picture; ///< a whole file, or nothing
    std::string problem; ///< why there is nothing
};

/// Runs gnuplot, which reads the script from its standard input and writes to its standard output: it opens
/// no file by a name, so no name can be taken for a command. The script sets a terminal for the format and no
/// output.
drawn_picture draw_picture(std::string_view script, picture_format format);
