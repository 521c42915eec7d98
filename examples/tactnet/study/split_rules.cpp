#include "study/split_rules.hpp"

#include "reports/html.hpp"

#include <fmt/format.h>

#include <algorithm>

std::string split_rules_table(const std::vector<study_row>& rows) {
    struct both {
        const study_row* row;
        double random, blocked; ///< in percent
    };
    std::vector<both> found;
    double lowest = 100;
    for (const study_row& row : rows) {
        const auto *random = find_accuracy(row, tactnet::split_rule::random),
                   *blocked = find_accuracy(row, tactnet::split_rule::blocked);
        if (random == nullptr || blocked == nullptr)
            continue;
        found.push_back({&row, 100 * random->test.mean, 100 * blocked->test.mean});
        lowest = std::min({lowest, found.back().random, found.back().blocked});
    }
    if (found.empty())
        return {};
    std::ranges::stable_sort(found, {}, [](const both& b) { return b.random - b.blocked; });
    const double begin = axis_below(lowest);
    std::string text =
        fmt::format("<h2>Random against blocked splits</h2>\n<div class=\"wide\"><table>\n<tr><th>method</th>"
                    "<th>random, %</th><th>blocked, %</th><th>points less</th>"
                    "<th class=\"bar\">{} to 100</th></tr>\n",
                    begin);
    for (const both& b : found)
        text += fmt::format("<tr><td>{}</td><td>{:.2f}</td><td>{:.2f}</td><td>{:.2f}</td>",
                            escaped(title_of(*b.row)), b.random, b.blocked, b.random - b.blocked) +
                bar_cell(b.blocked, b.random, begin) + "</tr>\n";
    return text +
           "</table></div>\n<p>Images that follow each other resemble each other. A blocked split keeps "
           "them together, so that a method is tested on touches that it has not nearly seen. The bar "
           "goes from one mean to the other.</p>\n";
}
