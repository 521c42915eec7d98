#include "study/page.hpp"

#include "methods/training_settings.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>

namespace {

using tactnet::split_rule;

std::string size_of(const study_row& row) {
    return fmt::format("{} × {}", row.rows, row.columns);
}
std::string mean_of(const tactnet::mean_and_deviation& m, const std::string& splits) {
    return fmt::format("{:.2f} ± {:.2f} ({})", 100 * m.mean, 100 * m.deviation, splits);
}
std::string accuracy_of(const study_row& row, split_rule rule) {
    const split_accuracies* const a = find_accuracy(row, rule);
    if (a == nullptr)
        return "";
    return mean_of(a->test, a->splits == a->wanted ? fmt::to_string(a->splits)
                                                   : fmt::format("{} of {}", a->splits, a->wanted));
}
std::string reflected_of(const study_row& row, split_rule rule) {
    const split_accuracies* const a = find_accuracy(row, rule);
    return a == nullptr || a->reflected_splits == 0
               ? ""
               : mean_of(a->reflected, fmt::to_string(a->reflected_splits));
}
std::string percent_of(double share) {
    return std::isfinite(share) ? fmt::format("{:.2f}", 100 * share) : "";
}
std::string time_of(const study_row& row, double frame_latency::*what, int digits = 1) {
    return row.latency ? fmt::format("{:.{}f}", (*row.latency).*what, digits) : "";
}
std::string count_of(std::size_t number) {
    return number > 0 ? grouped(number) : "";
}
std::string code_of(const study_row& row) {
    return row.declaration.empty() ? "" : "`" + row.declaration + "`";
}
std::string seconds_of(const study_row& row) {
    return row.accuracies.empty() ? "" : fmt::format("{:.1f}", row.seconds);
}

study_table front_table(const std::vector<study_row>& rows) {
    const split_rule rule = shown_rule(rows);
    const split_rule other = rule == split_rule::random ? split_rule::blocked : split_rule::random;
    study_table t{"front",
                  "Pareto front",
                  fmt::format("Methods with which no other is both faster and more accurate, over {} splits.",
                              name_of(rule)),
                  {{"method", "tactels", "µs per frame", fmt::format("accuracy, {} splits, %", name_of(rule)),
                    fmt::format("{} splits, %", name_of(other)), "parameters", "C++"}}};
    for (const study_row* row : pareto_front(rows, rule))
        t.cells.push_back(
            {method_title(*row) + (row->recipe == "default" ? "" : ", " + row->recipe + " recipe"),
             size_of(*row), time_of(*row, &frame_latency::median), accuracy_of(*row, rule),
             accuracy_of(*row, other), count_of(row->costs.parameters), code_of(*row)});
    return t;
}

study_table memory_table(const std::vector<study_row>& rows) {
    study_table t{"memory",
                  "Memory",
                  "Working memory: the largest set of activations alive at once.",
                  {{"method", "tactels", "weights, bytes", "working memory, bytes"}}};
    for (const study_row& row : rows)
        if (!row.declaration.empty() && row.recipe == "default") // a recipe changes no bytes
            t.cells.push_back({method_title(row), size_of(row), count_of(row.costs.parameter_bytes),
                               count_of(row.costs.activation_bytes)});
    return t;
}

std::string subject_of(const report_subject& of) {
    return fmt::format("{}. {}; {:%Y-%m-%d}.", of.images, of.program,
                       fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

} // namespace

study_table methods_table(const std::vector<study_row>& rows) {
    study_table t{"methods",
                  "All methods",
                  "Mean ± standard deviation of the accuracy on test images (number of splits).",
                  {{"method", "tactels", "recipe", "random splits, %", "the same, reflections averaged, %",
                    "blocked splits, %", "paper, random, %", "µs per frame", "p99", "paper, ms", "parameters",
                    "multiply-adds", "training, s"}}};
    for (const study_row& row : rows) {
        const published_result* const paper = row.published;
        t.cells.push_back(
            {method_title(row), size_of(row), row.accuracies.empty() ? "" : row.recipe,
             accuracy_of(row, split_rule::random), reflected_of(row, split_rule::random),
             accuracy_of(row, split_rule::blocked),
             paper == nullptr ? "" : fmt::format("{:.2f} ± {:.2f}", paper->accuracy, paper->deviation),
             time_of(row, &frame_latency::median), time_of(row, &frame_latency::p99),
             paper == nullptr || paper->seconds == 0 ? "" : fmt::format("{:.0f}", 1e3 * paper->seconds),
             count_of(row.costs.parameters), count_of(row.costs.multiply_adds), seconds_of(row)});
        if (!row.missing.empty())
            t.notes += fmt::format("- {}: {}\n", title_of(row), row.missing);
    }
    return t;
}

study_table details_table(const std::vector<study_row>& rows) {
    const split_rule rule = shown_rule(rows);
    study_table t{"details",
                  "Details",
                  fmt::format("Accuracies are means over {} splits. In batch: the time of a frame where many "
                              "pass together. Jitter: p99 ÷ median of a loop in registers that takes as long "
                              "as the frame; that much of p99 is the machine's.",
                              name_of(rule)),
                  {{"method", "tactels", "recipe", "validation, %", "training, %", "in batch, µs", "jitter",
                    "multiply-adds on pixels", "C++"}}};
    for (const study_row& row : rows)
        if (const auto* a = find_accuracy(row, rule); a != nullptr || row.latency)
            t.cells.push_back({method_title(row), size_of(row), row.recipe,
                               percent_of(a != nullptr ? a->validation : std::nan("")),
                               percent_of(a != nullptr ? a->training : std::nan("")),
                               time_of(row, &frame_latency::in_batch),
                               time_of(row, &frame_latency::jitter, 2),
                               count_of(row.costs.multiply_adds_on_pixels), code_of(row)});
    return t;
}

study_table probabilities_table(const std::vector<study_row>& rows) {
    study_table t{
        "probabilities",
        "How sure networks are",
        fmt::format(
            "Calibration error: by how much the probability of the recognised class differs from how "
            "often it is right, mean over 15 bins. Brier score: the mean square of that probability's "
            "error. Before: by the softmax. After: with logits divided by a temperature that each "
            "training fits to its validation images. All {} splits together.",
            name_of(shown_rule(rows))),
        {{"method", "tactels", "recipe", "temperature", "calibration error before, %", "after, %",
          "Brier score before", "after"}}};
    for (const study_row& row : rows)
        if (row.probabilities) {
            const auto& [scaling, before, after] = *row.probabilities;
            t.cells.push_back(
                {method_title(row), size_of(row), row.recipe, fmt::format("{:.2f}", scaling.temperature),
                 percent_of(before.calibration_error()), percent_of(after.calibration_error()),
                 fmt::format("{:.4f}", before.brier_score()), fmt::format("{:.4f}", after.brier_score())});
        }
    return t;
}

study_table decisions_table(const std::vector<study_row>& rows) {
    study_table t{"decisions",
                  "From frames to decisions",
                  fmt::format("{} All {} splits together.", decision_caption, name_of(shown_rule(rows))),
                  {{"method", "tactels", "recipe"}}};
    for (const decision_column& column : decision_columns)
        t.cells.front().emplace_back(column.title);
    for (const study_row& row : rows) {
        if (row.decisions.empty())
            continue;
        table_cells::value_type& cells = t.cells.emplace_back();
        cells = {method_title(row), size_of(row), row.recipe};
        for (const decision_column& column : decision_columns)
            cells.push_back(text_of(row.decisions, column));
    }
    return t;
}

std::vector<study_table> study_tables(const std::vector<study_row>& rows) {
    std::vector<study_table> all{front_table(rows),         methods_table(rows),   details_table(rows),
                                 probabilities_table(rows), decisions_table(rows), memory_table(rows)};
    std::erase_if(all, [](const study_table& t) { return t.cells.size() < 2; });
    return all;
}

std::string study_markdown(const std::vector<study_row>& rows, const report_subject& of) {
    std::string text = fmt::format("# What accuracy costs in time\n\n{} Accuracy on test images: mean ± "
                                   "standard deviation (number of splits). Times: median of single frames on "
                                   "one core.\n",
                                   subject_of(of));
    for (const study_table& t : study_tables(rows))
        text += fmt::format("\n## {}\n\n{}\n\n<!-- study {} -->\n{}{}{}<!-- study {} ends -->\n", t.title,
                            t.caption, t.name, markdown_table(t.cells), t.notes.empty() ? "" : "\n", t.notes,
                            t.name);
    return text;
}

std::string study_page(const std::vector<study_row>& rows,
                       const std::vector<std::pair<std::string, std::string>>& pictures,
                       const report_subject& of) {
    std::string body = fmt::format("<p>{} Each time is of one core.</p>\n", escaped(subject_of(of)));
    for (const auto& [caption, svg] : pictures)
        if (!svg.empty()) // without the declaration of an XML file
            body += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                                svg.substr(std::min(svg.find("<svg"), svg.size())), escaped(caption));
    for (const study_table& t : study_tables(rows))
        body += fmt::format("<h2>{}</h2>\n{}<p>{}\n{}</p>\n", escaped(t.title), html_table(t.cells),
                            escaped(t.caption), escaped(t.notes));
    std::string page(embedded("page.html"));
    return page.replace(page.find("<!-- report -->\n"), 16, body);
}
