#include "study/page/page.hpp"

#include "methods/description.hpp"
#include "methods/training_settings.hpp"
#include "reports/html.hpp"
#include "reports/report.hpp"
#include "study/page/class_rates.hpp"
#include "study/split_rules.hpp"
#include "study/times/instruction_sets.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <processor.hpp>
#include <string_view>

namespace {

using tactnet::split_rule;

constexpr std::string_view head = R"html(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<title>What accuracy costs in time</title>
<style>
:root { --surface: #fcfcfb; --text: #1b1b1a; --soft: #62625e; --line: #dcdcd8; --mark: 42, 120, 214; }
@media (prefers-color-scheme: dark) {
  :root { --surface: #1a1a19; --text: #f2f2ef; --soft: #a3a39e; --line: #3a3a38; --mark: 90, 160, 245; }
}
body { margin: 0 auto; max-width: 72rem; padding: 1.5rem 1rem 4rem; background: var(--surface);
       color: var(--text); font: 1rem/1.5 system-ui, sans-serif; }
h1 { font-size: 1.7rem; line-height: 1.2; margin: 0 0 .3rem; }
h2 { font-size: 1.2rem; margin: 2.5rem 0 .5rem; }
p, figcaption { color: var(--soft); max-width: 44rem; margin: .3rem 0; overflow-wrap: anywhere; }
figure { margin: 1.5rem 0; overflow-x: auto; }
figure svg { width: 100%; min-width: 40rem; height: auto; }
svg text, svg [fill="black"] { fill: var(--text); }
svg [stroke="black"] { stroke: var(--soft); }
svg use[color="white"] { color: var(--surface); }
svg [fill="rgb(255, 255, 255)"], svg polygon { fill: var(--surface); }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .9rem; font-variant-numeric: tabular-nums; }
th, td { padding: .25rem .7rem; border-bottom: 1px solid var(--line); text-align: right; white-space: nowrap; }
th { color: var(--soft); font-weight: 600; vertical-align: bottom; }
th:first-child, td:first-child, td.text { text-align: left; }
td.text { white-space: normal; min-width: 16rem; color: var(--soft); }
code { font: .85rem ui-monospace, monospace; }
.bar { min-width: 9rem; text-align: left; }
td.bar { position: relative; }
td.bar i { position: absolute; top: 50%; height: .5rem; margin-top: -.25rem; min-width: 2px; border-radius: .15rem;
           background: rgba(var(--mark), .8); }
.confusion td { padding: 0; width: 1.6rem; height: 1.6rem; text-align: center; font-size: .7rem; border: 1px solid var(--line); }
.confusion th { padding: 0 .4rem; font-size: .75rem; font-weight: 400; border: 0; text-align: right; }
.confusion thead th { writing-mode: vertical-rl; transform: rotate(180deg); text-align: left; padding: .4rem 0; }
#hint { position: fixed; display: none; max-width: 22rem; padding: .4rem .6rem; border: 1px solid var(--line); border-radius: .3rem;
        background: var(--surface); color: var(--text); font-size: .85rem; white-space: pre-line; pointer-events: none; }
</style>
</head>
<body>
)html";

/// What gnuplot calls for the text of a point.
constexpr std::string_view foot = R"html(<div id="hint" role="status"></div>
<script>
const hint = document.getElementById("hint");
const gnuplot_svg = {
  showHypertext(event, text) {
    hint.textContent = text.replaceAll("\\n", "\n");
    hint.style.display = "block";
    hint.style.left = Math.max(8, Math.min(event.clientX + 14, innerWidth - hint.offsetWidth - 8)) + "px";
    hint.style.top = Math.max(8, Math.min(event.clientY + 14, innerHeight - hint.offsetHeight - 8)) + "px";
  },
  hideHypertext() { hint.style.display = "none"; }
};
</script>
</body>
</html>
)html";

std::string cell(const std::string& text) {
    return "<td>" + escaped(text) + "</td>";
}

std::string percent_cell(const split_accuracies* a) {
    if (a == nullptr)
        return "<td></td>";
    std::string says = fmt::format("{} splits", a->splits);
    if (std::isfinite(a->training))
        says += fmt::format("; training images {:.2f} %", 100 * a->training);
    if (std::isfinite(a->validation))
        says += fmt::format("; validation {:.2f} %", 100 * a->validation);
    return fmt::format(
        "<td title=\"{}\">{:.2f} ± {:.2f}{}</td>", says, 100 * a->test.mean, 100 * a->test.deviation,
        a->splits == a->wanted ? "" : fmt::format("<br>{} of {} splits", a->splits, a->wanted));
}

/// On validation and training images, and on test images averaged over their reflections.
std::string other_percent_cells(const split_accuracies* a) {
    const auto text = [](double share) {
        return cell(std::isfinite(share) ? fmt::format("{:.2f}", 100 * share) : "");
    };
    if (a == nullptr)
        return "<td></td><td></td><td></td>";
    const std::string reflected =
        a->reflected_splits > 0
            ? fmt::format("<td title=\"{} splits\">{:.2f} ± {:.2f}</td>", a->reflected_splits,
                          100 * a->reflected.mean, 100 * a->reflected.deviation)
            : cell("");
    return text(a->validation) + text(a->training) + reflected;
}

std::string published_percent_cell(const published_result* p) {
    return cell(p == nullptr ? "" : fmt::format("{:.2f} ± {:.2f}", p->accuracy, p->deviation));
}
std::string published_time_cell(const published_result* p) {
    return cell(p == nullptr || p->seconds == 0 ? "" : fmt::format("{:.0f}", 1e3 * p->seconds));
}

std::string methods_table(const std::vector<study_row>& rows) {
    const split_rule rule = shown_rule(rows);
    std::string text =
        "<h2>All methods</h2>\n<div class=\"wide\"><table>\n<tr><th>method</th><th>size</th>"
        "<th>recipe</th><th>random, %</th><th>blocked, %</th><th>paper, %</th><th>validation, %</th>"
        "<th>training, %</th><th>reflections, %</th>"
        "<th>µs a frame</th><th>p99, µs</th><th>jitter</th><th>in batch, µs</th>"
        "<th>paper, ms</th><th>parameters</th><th>multiply-adds</th><th>training, s</th></tr>\n";
    for (const study_row& row : rows) {
        text += fmt::format("<tr><td title=\"{}\">{}</td>", escaped(row.declaration),
                            escaped(method_title(row))) +
                cell(fmt::format("{}×{}", row.rows, row.columns));
        if (row.accuracies.empty() && !row.latency) {
            text += "<td></td><td class=\"text\" colspan=\"2\">" + escaped(row.missing) + "</td>" +
                    published_percent_cell(row.published) + "<td colspan=\"7\"></td>" +
                    published_time_cell(row.published) + "<td colspan=\"3\"></td></tr>\n";
            continue;
        }
        text += cell(row.recipe) + percent_cell(find_accuracy(row, split_rule::random)) +
                percent_cell(find_accuracy(row, split_rule::blocked)) +
                published_percent_cell(row.published) + other_percent_cells(find_accuracy(row, rule));
        if (row.latency)
            text += fmt::format("<td>{:.1f}</td><td>{:.1f}</td><td>{:.2f}</td><td>{:.1f}</td>",
                                row.latency->median, row.latency->p99, row.latency->jitter,
                                row.latency->in_batch);
        else
            text += "<td></td><td></td><td></td><td></td>";
        text += published_time_cell(row.published) + cell(grouped(row.costs.parameters)) +
                cell(grouped(row.costs.multiply_adds)) +
                cell(row.accuracies.empty() ? "" : fmt::format("{:.1f}", row.seconds)) + "</tr>\n";
    }
    return text + fmt::format(
                      "</table></div>\n<p>Mean ± standard deviation of the accuracy on test images; the mean "
                      "on validation and training images, and that over an image and its three reflections, "
                      "is of {} "
                      "splits. Jitter: p99 ÷ median of a loop in "
                      "registers that takes as long as the frame; that much of p99 is the machine's.</p>\n",
                      name_of(rule));
}

/// From the fastest method to the most accurate: what each step costs.
std::string front_table(const std::vector<study_row>& rows) {
    const split_rule rule = shown_rule(rows);
    const auto front = pareto_front(rows, rule);
    if (front.size() < 2)
        return {};
    std::string text = "<h2>What one more point costs</h2>\n<div class=\"wide\"><table>\n<tr><th>method</th>"
                       "<th>accuracy, %</th><th>µs a frame</th><th>points more</th><th>µs more</th>"
                       "<th>µs a point</th></tr>\n";
    const study_row* before = nullptr;
    for (const study_row* row : front) {
        const double accuracy = 100 * find_accuracy(*row, rule)->test.mean;
        text +=
            fmt::format("<tr><td>{}{}</td><td>{:.2f}</td><td>{:.1f}</td>", escaped(title_of(*row)),
                        row->declaration.empty() ? "" : "<br><code>" + escaped(row->declaration) + "</code>",
                        accuracy, row->latency->median);
        if (before != nullptr) {
            const double points = accuracy - 100 * find_accuracy(*before, rule)->test.mean,
                         time = row->latency->median - before->latency->median;
            text += fmt::format("<td>{:.2f}</td><td>{:.1f}</td><td>{:.1f}</td>", points, time, time / points);
        } else
            text += "<td></td><td></td><td></td>";
        text += "</tr>\n";
        before = row;
    }
    return text +
           fmt::format(
               "</table></div>\n<p>Methods with which no other is both faster and more accurate, over {} "
               "splits.</p>\n",
               name_of(rule));
}

/// Shares of the true class in colour, counts in figures.
std::string confusion_table(const study_row& row, split_rule rule) {
    std::string text = fmt::format("<h2>What {} takes for what</h2>\n<div class=\"wide\">"
                                   "<table class=\"confusion\">\n<thead><tr><th></th>",
                                   escaped(title_of(row)));
    for (const std::string& name : row.classes)
        text += "<th>" + escaped(name) + "</th>";
    text += "</tr></thead>\n";
    for (std::size_t truth = 0; truth < row.classes.size(); ++truth) {
        std::size_t total = 0;
        for (std::size_t c = 0; c < row.classes.size(); ++c)
            total += row.confusion(truth, c);
        text += "<tr><th>" + escaped(row.classes[truth]) + "</th>";
        for (std::size_t c = 0; c < row.classes.size(); ++c) {
            const std::size_t n = row.confusion(truth, c);
            text += n == 0 ? "<td></td>"
                           : fmt::format("<td style=\"background:rgba(var(--mark),{:.3f})\">{}</td>",
                                         0.1 + 0.8 * static_cast<double>(n) / static_cast<double>(total), n);
        }
        text += "</tr>\n";
    }
    return text +
           fmt::format(
               "</table></div>\n<p>A row is what an image shows, a column what it was taken for; all {} "
               "splits together.</p>\n",
               name_of(rule));
}

const study_row* most_accurate(const std::vector<study_row>& rows, split_rule rule) {
    const study_row* best = nullptr;
    for (const study_row& row : rows)
        if (const auto* a = find_accuracy(row, rule))
            if (best == nullptr || a->test.mean > find_accuracy(*best, rule)->test.mean)
                best = &row;
    return best;
}

} // namespace

std::string study_page(const std::vector<study_row>& rows, const std::vector<drawn_study_picture>& pictures,
                       const std::string& images) {
    const auto program = describe_program();
    std::string page(head);
    page += fmt::format("<h1>What accuracy costs in time</h1>\n<p>{}; {}, {}; tactnet {}; {:%Y-%m-%d}. Each "
                        "time is of one core of this machine.</p>\n",
                        escaped(processor_name()), escaped(compiler_name()),
                        escaped(program.at("instruction_set")), escaped(program.at("library")),
                        fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
    page += fmt::format("<p>{}</p>\n", escaped(images));
    for (const drawn_study_picture& picture : pictures)
        if (!picture.svg.empty()) {
            const auto begin = picture.svg.find("<svg"); // without the declaration of an XML file
            page += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n",
                                picture.svg.substr(std::min(begin, picture.svg.size())),
                                escaped(picture.caption));
        }
    page += front_table(rows) + methods_table(rows) + instruction_sets_table(rows) + split_rules_table(rows);
    const split_rule rule = shown_rule(rows);
    if (const study_row* best = most_accurate(rows, rule))
        page += class_rates_table(*best, rule) + confusion_table(*best, rule);
    return page + std::string(foot);
}
