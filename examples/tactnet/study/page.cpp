#include "study/page.hpp"

#include "reports/pictures.hpp"
#include "study/published.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <functional>

namespace {

using tactnet::split_rule;

/// A column of a table: its head, and what of a row stands in it.
struct column {
    std::string title;
    std::function<std::string(const study_row&)> cell;
};

column fixed(std::string title, const std::string& member, int digits, double factor = 1) {
    return {std::move(title), [=](const study_row& row) {
                const double value = factor * number(row, member);
                return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "";
            }};
}
column percent(std::string title, const std::string& member) {
    return fixed(std::move(title), member, 2, 100);
}
column count(std::string title, const std::string& member) {
    return {std::move(title), [=](const study_row& row) {
                const double value = number(row, member);
                return value > 0 ? grouped(static_cast<std::size_t>(value)) : "";
            }};
}
/// "97.80 ± 0.92 (20)", or "(18 of 20)" where splits are missing.
column accuracy(std::string title, split_rule rule, const std::string& kind = "") {
    return {std::move(title), [=](const study_row& row) -> std::string {
                const double mean = number(row, rule, kind + "accuracy"),
                             deviation = number(row, rule, kind + "deviation"),
                             splits = number(row, rule, kind + "splits"),
                             wanted = number(row, rule, "splits_wanted");
                if (!std::isfinite(mean))
                    return "";
                return fmt::format("{:.2f} ± {:.2f} ({}{})", 100 * mean, 100 * deviation, splits,
                                   kind.empty() && splits < wanted ? fmt::format(" of {}", wanted) : "");
            }};
}
column by_rule(const std::string& title, split_rule rule, const std::string& member) {
    return {title, [=](const study_row& row) {
                const double value = 100 * number(row, rule, member);
                return std::isfinite(value) ? fmt::format("{:.2f}", value) : "";
            }};
}

const column method_column{"method", method_title};
const column size_column{"tactels", [](const study_row& row) {
                             return fmt::format("{} × {}", number(row, "rows"), number(row, "columns"));
                         }};
const column recipe_column{"recipe", [](const study_row& row) { return text(row, "recipe"); }};
const column paper_column{"paper, random, %", [](const study_row& row) {
                              const double mean = number(row, "published_accuracy");
                              return std::isfinite(mean)
                                         ? fmt::format("{:.2f} ± {:.2f}", 100 * mean,
                                                       100 * number(row, "published_deviation"))
                                         : "";
                          }};
const column type_column{"C++", [](const study_row& row) {
                             const std::string type = text(row, "declaration");
                             return type.empty() ? "" : '`' + type + '`';
                         }};

bool every(const study_row&) {
    return true;
}

/// With a line for each row that is wanted.
study_table table_of(study_table about, const std::vector<column>& columns,
                     const std::vector<study_row>& rows, bool (*wanted)(const study_row&) = every) {
    about.cells.emplace_back();
    for (const column& c : columns)
        about.cells.front().push_back(c.title);
    for (const study_row& row : rows) {
        if (!wanted(row))
            continue;
        about.cells.emplace_back();
        for (const column& c : columns)
            about.cells.back().push_back(c.cell(row));
    }
    return about;
}

study_table front_table(const std::vector<study_row>& rows) {
    const split_rule rule = shown_rule(rows);
    const split_rule other = rule == split_rule::random ? split_rule::blocked : split_rule::random;
    const column method{"method", [](const study_row& row) {
                            const std::string recipe = text(row, "recipe");
                            return method_title(row) + (recipe == "default" ? "" : ", " + recipe + " recipe");
                        }};
    return table_of(
        {"front", "Pareto front",
         fmt::format("Methods with which no other is both faster and more accurate, over {} splits.",
                     name_of(rule))},
        {method, size_column, fixed("µs per frame", "microseconds", 1),
         accuracy(fmt::format("accuracy, {} splits, %", name_of(rule)), rule),
         accuracy(fmt::format("{} splits, %", name_of(other)), other), count("parameters", "parameters"),
         type_column},
        pareto_front(rows, rule));
}

study_table memory_table(const std::vector<study_row>& rows) {
    return table_of({"memory", "Memory", "Working memory: the largest set of activations alive at once.", {}},
                    {method_column, size_column, count("weights, bytes", "bytes"),
                     count("working memory, bytes", "activation_bytes")},
                    rows, [](const study_row& row) { // a recipe changes no bytes
                        return !text(row, "declaration").empty() && text(row, "recipe") == "default";
                    });
}

/// A point of a picture. Accuracies in percent; gnuplot ends a text at a comma, quoted or not.
nlohmann::ordered_json point(std::string series, double x, double accuracy, double deviation,
                             std::string label = "") {
    std::ranges::replace(series, ',', ';');
    std::ranges::replace(label, ',', ';');
    return {{"series", series}, {"x", x}, {"accuracy", accuracy}, {"deviation", deviation}, {"label", label}};
}
nlohmann::ordered_json point(const std::string& series, double x, const study_row& row, split_rule rule) {
    return point(series, x, 100 * number(row, rule, "accuracy"), 100 * number(row, rule, "deviation"));
}

bool has_paper(const std::vector<study_row>& rows) {
    return std::ranges::any_of(
        rows, [](const study_row& row) { return std::isfinite(number(row, "published_accuracy")); });
}

/// Accuracy against microseconds: each method, the Pareto front and the paper.
study_picture costs_picture(const std::vector<study_row>& rows) {
    const split_rule rule = shown_rule(rows);
    std::vector<nlohmann::ordered_json> points;
    for (const study_row& row : rows)
        if (const double time = number(row, "microseconds");
            std::isfinite(time) && std::isfinite(number(row, rule, "accuracy")))
            points.push_back(point(row.family, time, row, rule));
    for (const published_result& p : published_results)
        if (p.seconds > 0 && has_paper(rows))
            points.push_back(point("paper", 1e6 * p.seconds, p.accuracy, p.deviation));
    const std::vector<study_row> front = pareto_front(rows, rule);
    double errors = -1; // of the last that has its name, from the top: each well below the one before
    for (auto row = front.rbegin(); row != front.rend(); ++row) {
        const double accuracy = 100 * number(*row, rule, "accuracy"), time = number(*row, "microseconds");
        points.push_back(point("front", time, accuracy, 0));
        if (100 - accuracy <= 1.15 * errors)
            continue;
        points.push_back(point("names", time, accuracy, 0, title_of(*row)));
        errors = 100 - accuracy;
    }
    return {"accuracy_and_time",
            fmt::format("Test accuracy over {} splits against time per frame on one core; bars are "
                        "standard deviations. The paper's figures are of its own images and machine.",
                        name_of(rule)),
            csv_of(points)};
}

/// Accuracy against the number of tactels, of methods that were tried at several sizes.
study_picture sizes_picture(const std::vector<study_row>& rows) {
    const split_rule rule = shown_rule(rows);
    std::map<std::string, std::map<double, nlohmann::ordered_json>> methods; // by tactels
    for (const study_row& row : rows)
        if (std::isfinite(number(row, rule, "accuracy"))) {
            const std::string name = fmt::format("{} {}", method_title(row), text(row, "recipe"));
            const double tactels = number(row, "rows") * number(row, "columns");
            methods[name][tactels] = point(name, tactels, row, rule);
        }
    std::erase_if(methods, [](const auto& method) { return method.second.size() < 2; });
    const std::string paper = "TactNet-6 in the paper";
    if (!methods.empty() && has_paper(rows))
        for (const published_result& p : published_results)
            if (const auto tactels = static_cast<double>(p.rows * p.columns); p.method == "tactnet6")
                methods[paper][tactels] = point(paper, tactels, p.accuracy, p.deviation);
    study_picture picture{
        "accuracy_and_tactels",
        fmt::format("Test accuracy over {} splits against the number of tactels.", name_of(rule)), ""};
    std::vector<nlohmann::ordered_json> points;
    for (const auto& [name, by_tactels] : methods) {
        picture.series.push_back(name);
        for (const auto& [tactels, found] : by_tactels)
            points.push_back(found);
    }
    picture.csv = csv_of(points);
    return picture;
}

} // namespace

study_table methods_table(const std::vector<study_row>& rows) {
    std::vector<column> columns{method_column, size_column, recipe_column};
    for (const auto& [name, rule] : split_rule_names) {
        const bool usual = rule == split_rule::random || rule == split_rule::blocked;
        if (usual || std::ranges::any_of(rows, [&](const study_row& row) {
                return std::isfinite(number(row, rule, "accuracy"));
            }))
            columns.push_back(accuracy(fmt::format("{} splits, %", name), rule));
        if (rule == split_rule::random)
            columns.push_back(accuracy("the same, reflections averaged, %", rule, "reflected_"));
    }
    for (const column& next :
         {paper_column, fixed("µs per frame", "microseconds", 1), fixed("p99", "microseconds_p99", 1),
          fixed("paper, ms", "published_microseconds", 0, 1e-3), count("parameters", "parameters"),
          count("multiply-adds", "multiply_adds"), fixed("training, s", "training_seconds", 1)})
        columns.push_back(next);
    return table_of({"methods", "All methods",
                     "Mean ± standard deviation of the accuracy on test images (number of splits)."},
                    columns, rows);
}

study_table details_table(const std::vector<study_row>& rows) {
    const split_rule rule = shown_rule(rows);
    return table_of({"details", "Details",
                     fmt::format("Accuracies are means over {} splits. In batch: the time of a frame where "
                                 "many pass together. Jitter: p99 ÷ median of a loop in registers that takes "
                                 "as long as the frame; that much of p99 is the machine's.",
                                 name_of(rule))},
                    {method_column, size_column, recipe_column,
                     by_rule("validation, %", rule, "validation_accuracy"),
                     by_rule("training, %", rule, "training_accuracy"),
                     fixed("in batch, µs", "microseconds_in_batch", 1), fixed("jitter", "jitter", 2),
                     count("multiply-adds on pixels", "multiply_adds_on_pixels"), type_column},
                    rows, [](const study_row& row) {
                        return std::isfinite(number(row, "microseconds")) ||
                               std::ranges::any_of(split_rule_names, [&](const auto& known) {
                                   return std::isfinite(number(row, known.second, "accuracy"));
                               });
                    });
}

study_table probabilities_table(const std::vector<study_row>& rows) {
    return table_of(
        {"probabilities", "How sure networks are",
         fmt::format(
             "Calibration error: by how much the probability of the recognised class differs from how "
             "often it is right, mean over 15 bins. Brier score: the mean square of that probability's "
             "error. Before: by the softmax. After: with logits divided by a temperature that each "
             "training fits to its validation images. All {} splits together.",
             name_of(shown_rule(rows)))},
        {method_column, size_column, recipe_column, fixed("temperature", "temperature", 2),
         percent("calibration error before, %", "softmax_calibration_error"),
         percent("after, %", "calibration_error"), fixed("Brier score before", "softmax_brier_score", 4),
         fixed("after", "brier_score", 4)},
        rows, [](const study_row& row) { return std::isfinite(number(row, "temperature")); });
}

std::string study_page(const std::vector<study_row>& rows, const std::vector<study_picture>& pictures,
                       const std::string& about) {
    std::string page = fmt::format(
        "# What accuracy costs in time\n\n{}; {:%Y-%m-%d}. Accuracy on test images: mean ± standard "
        "deviation (number of splits). Times: median of single frames on one core.\n",
        about, fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
    for (const study_picture& p : pictures)
        page += fmt::format("\n![{0}]({1}.png)\n\n{0}\n", p.caption, p.name);
    for (const study_table& t : {front_table(rows), methods_table(rows), details_table(rows),
                                 probabilities_table(rows), memory_table(rows)})
        if (t.cells.size() > 1)
            page += fmt::format("\n## {}\n\n{}\n\n<!-- study {} -->\n{}<!-- study {} ends -->\n", t.title,
                                t.caption, t.name, markdown_table(t.cells), t.name);
    return page;
}

std::vector<study_picture> study_pictures(const std::vector<study_row>& rows) {
    std::vector<study_picture> pictures{costs_picture(rows), sizes_picture(rows)};
    std::erase_if(pictures, [](const study_picture& picture) { return picture.csv.empty(); });
    return pictures;
}

std::vector<study_picture> draw_study_pictures(const std::vector<study_row>& rows,
                                               const std::filesystem::path& folder) {
    std::vector<study_picture> drawn = study_pictures(rows);
    std::erase_if(drawn, [&](const study_picture& p) {
        return !draw_picture(p.name, folder / p.name, p.csv, "", p.series);
    });
    return drawn;
}

void check_study_files(const std::filesystem::path& folder, std::vector<std::string> files,
                       std::set<std::filesystem::path> pictures, const std::vector<named_file>& inputs,
                       const std::filesystem::path& data, const candidate_list& candidates) {
    files.push_back("evaluation.jsonl");
    if (std::ranges::any_of(candidates, [](const candidate& c) { return c.what->keeps_features(); }))
        files.push_back("features/any");
    std::vector<named_file> outputs;
    for (const std::string& name : files)
        outputs.push_back({"--results", folder / name});
    for (const char* name : {"accuracy_and_time", "accuracy_and_tactels"})
        pictures.insert(folder / name);
    for (const std::filesystem::path& stem : pictures)
        add_picture(outputs, "--results", stem);
    check_outputs(inputs, outputs, data);
}
