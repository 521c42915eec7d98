#pragma once

// What the scripts of all pictures of a study share.

#include <fmt/format.h>

#include <string>
#include <string_view>

/// Lines of numbers under a name, as $name.
inline std::string gnuplot_data(std::string_view name, const std::string& lines) {
    return fmt::format("${} << END\n{}END\n", name, lines);
}

inline constexpr std::string_view gnuplot_style =
    "set border 3 lc rgb '#8a8a86'\nset tics nomirror\n"
    "set grid lc rgb '#d0d0cc' lw 0.5\nset key opaque\nset pointintervalbox 0\nset termoption noenhanced\n";
