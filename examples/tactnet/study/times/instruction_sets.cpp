#include "study/times/instruction_sets.hpp"

#include "reports/html.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>
#include <utility>

namespace {

using named_level = std::pair<std::string_view, std::string_view>;

/// Of each line, those that hold the others first.
constexpr std::array<named_level, 10> levels{{{"_avx512f", "AVX-512"},
                                              {"_avx2", "AVX2"},
                                              {"_avx", "AVX"},
                                              {"_sse42", "SSE4.2"},
                                              {"_sse41", "SSE4.1"},
                                              {"_ssse3", "SSSE3"},
                                              {"_sse3", "SSE3"},
                                              {"_sse2", "SSE2"},
                                              {"_sve", "SVE"},
                                              {"_neon64", "NEON"}}};

constexpr std::string_view without_vectors = "scalar";

/// Its place in a table: the place of its level; behind all others where vectors are not used.
std::size_t rank_of(std::string_view name) {
    const auto level =
        std::ranges::find_if(levels, [&](const named_level& l) { return name.find(l.first) != name.npos; });
    return static_cast<std::size_t>(level - levels.begin()) +
           (name.starts_with(without_vectors) ? levels.size() + 1 : 0);
}

} // namespace

std::string instruction_set_title(std::string_view name) {
    const std::size_t rank = rank_of(name) % (levels.size() + 1);
    const std::string level(rank < levels.size() ? levels[rank].second : name);
    return name.starts_with(without_vectors) ? "no vectors (" + level + ")" : level;
}

std::string instruction_sets_table(const std::vector<study_row>& rows) {
    const auto earlier = [](const std::string& a, const std::string& b) {
        return std::pair(rank_of(a), a) < std::pair(rank_of(b), b);
    };
    std::set<std::string, decltype(earlier)> sets(earlier);
    for (const study_row& row : rows)
        for (const auto& [name, latency] : row.by_instruction_set)
            sets.insert(name);
    if (sets.size() < 2)
        return {};
    std::string text = "<h2>Other instruction sets</h2>\n<div class=\"wide\"><table>\n<tr><th>method</th>";
    for (const std::string& name : sets)
        text += fmt::format("<th title=\"{}\">{}</th>", escaped(name), escaped(instruction_set_title(name)));
    text += "</tr>\n";
    std::set<std::string> shown; // a recipe changes no time
    for (const study_row& row : rows) {
        const std::string title = fmt::format("{} {}×{}", method_title(row), row.rows, row.columns);
        if (row.by_instruction_set.size() < 2 || !shown.insert(title).second)
            continue;
        text += "<tr><td>" + escaped(title) + "</td>";
        for (const std::string& name : sets) {
            const auto found = row.by_instruction_set.find(name);
            text += found == row.by_instruction_set.end()
                        ? "<td></td>"
                        : fmt::format("<td>{:.1f}</td>", found->second.median);
        }
        text += "</tr>\n";
    }
    return text +
           "</table></div>\n<p>Microseconds a frame, median, of programs that were compiled for each, on "
           "the same machine.</p>\n";
}
