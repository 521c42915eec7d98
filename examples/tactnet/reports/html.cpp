#include "reports/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

std::string escaped(std::string_view text) {
    std::string result;
    for (const char c : text)
        result += c == '&'   ? std::string("&amp;")
                  : c == '<' ? std::string("&lt;")
                  : c == '>' ? std::string("&gt;")
                  : c == '"' ? std::string("&quot;")
                             : std::string(1, c);
    return result;
}

double axis_below(double lowest) {
    return std::clamp(5 * std::floor((lowest - 1) / 5), 0.0, 95.0);
}

std::string bar_cell(double one, double other, double axis) {
    const auto place = [&](double value) {
        return 100 * (std::clamp(value, axis, 100.0) - axis) / (100 - axis);
    };
    const double begin = place(std::min(one, other)), end = place(std::max(one, other));
    return fmt::format("<td class=\"bar\"><i style=\"left:{:.1f}%;width:{:.1f}%\"></i></td>", begin,
                       end - begin);
}
