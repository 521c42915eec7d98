#include "study/page/markdown.hpp"

#include "methods/description.hpp"
#include "methods/training_settings.hpp"
#include "reports/report.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <processor.hpp>
#include <string_view>

namespace {

using tactnet::split_rule;

/// In a table's cell.
std::string plain(std::string_view text) {
    std::string result;
    for (const char c : text)
        result += c == '|' || c == '\\' ? std::string{'\\', c} : std::string{c};
    return result;
}

std::string accuracy_of(const split_accuracies* a) {
    return a == nullptr
               ? ""
               : fmt::format("{:.2f} ± {:.2f} ({})", 100 * a->test.mean, 100 * a->test.deviation, a->splits);
}
std::string reflected_of(const split_accuracies* a) {
    return a == nullptr || a->reflected_splits == 0
               ? ""
               : fmt::format("{:.2f} ± {:.2f} ({})", 100 * a->reflected.mean, 100 * a->reflected.deviation,
                             a->reflected_splits);
}
std::string microseconds_of(const study_row& row) {
    return row.latency ? fmt::format("{:.1f}", row.latency->median) : "";
}
std::string count_of(std::size_t number) {
    return number > 0 ? grouped(number) : "";
}

std::string line_of(const std::vector<std::string>& cells) {
    std::string line = "|";
    for (const std::string& cell : cells)
        line += " " + cell + (cell.empty() ? "|" : " |");
    return line + "\n";
}

std::string between(std::string_view name, const std::string& text) {
    return fmt::format("<!-- study {} -->\n{}<!-- study {} ends -->\n", name, text, name);
}

std::string front(const std::vector<study_row>& rows) {
    const split_rule rule = shown_rule(rows);
    const split_rule other = rule == split_rule::random ? split_rule::blocked : split_rule::random;
    std::string text =
        line_of({"method", "tactels", "µs a frame", fmt::format("accuracy, {} splits, %", name_of(rule)),
                 fmt::format("{} splits, %", name_of(other)), "parameters", "C++"}) +
        line_of(std::vector<std::string>(7, "---"));
    for (const study_row* row : pareto_front(rows, rule))
        text += line_of(
            {plain(method_title(*row)) + (row->recipe == "default" ? "" : ", " + row->recipe + " recipe"),
             fmt::format("{} × {}", row->rows, row->columns), microseconds_of(*row),
             accuracy_of(find_accuracy(*row, rule)), accuracy_of(find_accuracy(*row, other)),
             count_of(row->costs.parameters),
             row->declaration.empty() ? "" : "`" + plain(row->declaration) + "`"});
    return text;
}

std::string methods(const std::vector<study_row>& rows) {
    std::string text =
        line_of({"method", "tactels", "recipe", "random splits, %", "the same, reflections averaged, %",
                 "blocked splits, %", "paper, random, %", "µs a frame", "p99", "paper, ms", "parameters",
                 "multiply-adds", "training, s"}) +
        line_of(std::vector<std::string>(13, "---"));
    std::string reasons;
    for (const study_row& row : rows) {
        const published_result* paper = row.published;
        text += line_of(
            {plain(method_title(row)), fmt::format("{} × {}", row.rows, row.columns),
             row.accuracies.empty() ? "" : row.recipe, accuracy_of(find_accuracy(row, split_rule::random)),
             reflected_of(find_accuracy(row, split_rule::random)),
             accuracy_of(find_accuracy(row, split_rule::blocked)),
             paper == nullptr ? "" : fmt::format("{:.2f} ± {:.2f}", paper->accuracy, paper->deviation),
             microseconds_of(row), row.latency ? fmt::format("{:.1f}", row.latency->p99) : "",
             paper == nullptr || paper->seconds == 0 ? "" : fmt::format("{:.0f}", 1e3 * paper->seconds),
             count_of(row.costs.parameters), count_of(row.costs.multiply_adds),
             row.accuracies.empty() ? "" : fmt::format("{:.1f}", row.seconds)});
        if (!row.missing.empty())
            reasons += fmt::format("- {}: {}\n", plain(title_of(row)), plain(row.missing));
    }
    return text + (reasons.empty() ? "" : "\n" + reasons);
}

/// What networks take of memory; empty where nobody says what their code takes.
std::string memory(const std::vector<study_row>& rows) {
    std::string text;
    for (const study_row& row : rows) {
        if (row.code_bytes == 0 || row.recipe != "default")
            continue; // a recipe changes no bytes
        text += line_of({plain(method_title(row)), fmt::format("{} × {}", row.rows, row.columns),
                         count_of(row.costs.parameter_bytes), count_of(row.costs.activation_bytes),
                         count_of(row.code_bytes)});
    }
    if (text.empty())
        return {};
    return line_of({"method", "tactels", "weights, bytes", "working memory, bytes", "code, bytes"}) +
           line_of(std::vector<std::string>(5, "---")) + text;
}

/// To two digits: times of two machines tell no more.
std::size_t two_digits(double ratio) {
    const double unit = std::pow(10, std::max(0.0, std::floor(std::log10(ratio)) - 1));
    return static_cast<std::size_t>(std::lround(ratio / unit) * std::lround(unit));
}

/// For each method of the paper the fastest here that is at least as accurate over random splits, and how
/// many times as fast; empty where nothing is to be compared.
std::string against_paper(const std::vector<study_row>& rows) {
    std::string text;
    const auto ours = pareto_front(rows, split_rule::random); // the fastest first, each more accurate
    for (const published_result& paper : published_results) {
        if (paper.seconds == 0)
            continue;
        const auto accuracy = [](const study_row* row) {
            return find_accuracy(*row, split_rule::random)->test.mean;
        };
        const auto row = std::ranges::find_if(
            ours, [&](const study_row* r) { return 100 * accuracy(r) >= paper.accuracy; });
        if (row == ours.end())
            continue;
        text += line_of({std::string(paper.title), fmt::format("{:.2f}", paper.accuracy),
                         grouped(static_cast<std::size_t>(std::lround(1e3 * paper.seconds))),
                         plain(title_of(**row)), accuracy_of(find_accuracy(**row, split_rule::random)),
                         microseconds_of(**row),
                         grouped(two_digits(1e6 * paper.seconds / (*row)->latency->median))});
    }
    if (text.empty())
        return {};
    return line_of({"in the paper", "accuracy, %", "ms an image", "here, at least as accurate", "accuracy, %",
                    "µs a frame", "times as fast"}) +
           line_of(std::vector<std::string>(7, "---")) + text;
}

} // namespace

std::string study_markdown(const std::vector<study_row>& rows, const std::string& images) {
    const auto program = describe_program();
    const bool touches =
        std::ranges::any_of(rows, [](const study_row& row) { return row.published != nullptr; });
    const std::string bytes = memory(rows);
    const std::string against = touches ? against_paper(rows) : "";
    return fmt::format("# What accuracy costs in time\n\n{}. {}, {}, {}; tactnet {}; {:%Y-%m-%d}. Accuracy "
                       "on test images: "
                       "mean ± standard deviation (number of splits). Times: median of single frames on one "
                       "core.\n\n",
                       images, processor_name(), compiler_name(), program.at("instruction_set"),
                       program.at("library"),
                       fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now()))) +
           "Methods with which no other is both faster and more accurate:\n\n" +
           between("front", front(rows)) + "\nAll methods:\n\n" + between("methods", methods(rows)) +
           (against.empty() ? ""
                            : "\nFor each method of the paper, the fastest here whose mean accuracy is at "
                              "least as high:\n\n" +
                                  between("against", against)) +
           (bytes.empty() ? "" : "\nWhat they take of memory:\n\n" + between("memory", bytes));
}
