#include "console/suggestion.hpp"

#include <algorithm>
#include <cstddef>

namespace {

/// Slips that lead from one word to the other (optimal string alignment).
std::size_t slips(std::string_view a, std::string_view b) {
    const std::size_t width = b.size() + 1;
    std::vector<std::size_t> table((a.size() + 1) * width);
    const auto at = [&](std::size_t i, std::size_t j) -> std::size_t& { return table[i * width + j]; };
    for (std::size_t i = 0; i <= a.size(); ++i)
        for (std::size_t j = 0; j <= b.size(); ++j) {
            if (i == 0 || j == 0) {
                at(i, j) = i + j;
                continue;
            }
            at(i, j) = std::min({at(i - 1, j) + 1, at(i, j - 1) + 1,
                                 at(i - 1, j - 1) + static_cast<std::size_t>(a[i - 1] != b[j - 1])});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                at(i, j) = std::min(at(i, j), at(i - 2, j - 2) + 1);
        }
    return table.back();
}

} // namespace

std::string closest_name(std::string_view typed, const std::vector<std::string>& names) {
    if (typed.size() > 100) // no slip, and a large table
        return {};
    std::string closest;
    std::size_t fewest = 3;
    for (const std::string& name : names)
        if (const std::size_t n = slips(typed, name); n < fewest && 2 * n < name.size())
            fewest = n, closest = name;
    return closest;
}
