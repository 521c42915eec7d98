#include "study/pictures.hpp"

#include "reports/pictures.hpp"
#include "study/published.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace {

using tactnet::split_rule;

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
    const auto front = pareto_front(rows, rule);
    double errors = -1; // of the last that has its name, from the top: each well below the one before
    for (auto row = front.rbegin(); row != front.rend(); ++row) {
        const double accuracy = 100 * number(**row, rule, "accuracy"), time = number(**row, "microseconds");
        points.push_back(point("front", time, accuracy, 0));
        if (100 - accuracy <= 1.15 * errors)
            continue;
        points.push_back(point("names", time, accuracy, 0, title_of(**row)));
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

std::vector<study_picture> study_pictures(const std::vector<study_row>& rows) {
    std::vector<study_picture> pictures{costs_picture(rows), sizes_picture(rows)};
    std::erase_if(pictures, [](const study_picture& picture) { return picture.csv.empty(); });
    return pictures;
}

std::vector<page_picture> draw_study_pictures(const std::vector<study_row>& rows,
                                              const std::filesystem::path& folder) {
    std::vector<page_picture> drawn;
    for (const study_picture& p : study_pictures(rows))
        if (draw_picture(p.name + ".gnuplot", folder / p.name, p.csv, {.names = p.series}))
            drawn.push_back({p.name + ".png", p.caption});
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
        std::ranges::move(picture_files("--results", stem), std::back_inserter(outputs));
    check_outputs(inputs, outputs, data);
}
