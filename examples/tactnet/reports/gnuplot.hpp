#pragma once

#include <string>
#include <string_view>

/// What gnuplot made of a script.
struct drawn_picture {
    std::string picture; ///< a whole PNG file, or nothing
    std::string problem; ///< why there is nothing
};

/// Runs gnuplot, which reads the script from its standard input and writes to its standard output: it opens
/// no file by a name, so no name can be taken for a command. The script sets a terminal for PNG and no
/// output.
drawn_picture draw_png(std::string_view script);
