#include "study/pictures.hpp"

#include "methods/training_settings.hpp"
#include "reports/pictures.hpp"
#include "reports/report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <map>
#include <string_view>
#include <utility>

namespace {

using tactnet::split_rule;

/// gnuplot ends a text at a comma, quoted or not.
std::string without_commas(std::string text) {
    std::ranges::replace(text, ',', ';');
    return text;
}

/// A point of a picture. Accuracies in percent.
nlohmann::ordered_json point(const std::string& series, double x, double accuracy, double deviation,
                             const std::string& words) {
    return {{"series", without_commas(series)},
            {"x", x},
            {"accuracy", accuracy},
            {"deviation", deviation},
            {"words", without_commas(words)}};
}

std::string_view family_of(const study_row& row) {
    constexpr std::array<std::string_view, 3> names{"touches", "photographs", "machines"};
    return names[static_cast<std::size_t>(row.family)];
}

bool has_paper(const std::vector<study_row>& rows) {
    return std::ranges::any_of(rows, [](const study_row& row) { return row.published != nullptr; });
}

/// What the pointer shows, with \n in place of line feeds.
std::string words_of(const study_row& row) {
    std::string text =
        fmt::format("{} {}x{}\\n{} recipe", method_title(row), row.rows, row.columns, row.recipe);
    for (const auto& a : row.accuracies)
        text += fmt::format("\\n{:.2f} ± {:.2f} % over {} {} splits", 100 * a.test.mean,
                            100 * a.test.deviation, a.splits, name_of(a.rule));
    return text + (row.latency ? fmt::format("\\n{:.1f} µs per frame", row.latency->median) : "");
}

/// Accuracy against microseconds: each method, the Pareto front and the paper.
study_picture costs_picture(const std::vector<study_row>& rows) {
    const split_rule rule = shown_rule(rows);
    std::vector<nlohmann::ordered_json> points;
    for (const study_row& row : rows)
        if (const auto* a = find_accuracy(row, rule); a != nullptr && row.latency)
            points.push_back(point(std::string(family_of(row)), row.latency->median, 100 * a->test.mean,
                                   100 * a->test.deviation, words_of(row)));
    for (const published_result& p : published_results)
        if (p.seconds > 0 && has_paper(rows))
            points.push_back(point("paper", 1e6 * p.seconds, p.accuracy, p.deviation,
                                   fmt::format("the paper: {}\\n{:.2f} ± {:.2f} %\\n{:.0f} ms an image",
                                               p.title, p.accuracy, p.deviation, 1e3 * p.seconds)));
    const auto front = pareto_front(rows, rule);
    double errors = -1; // of the last that has its name, from the top: each well below the one before
    for (auto row = front.rbegin(); row != front.rend(); ++row) {
        const double accuracy = 100 * find_accuracy(**row, rule)->test.mean;
        const auto add = [&](const char* series) {
            points.push_back(point(series, (*row)->latency->median, accuracy, 0, title_of(**row)));
        };
        add("front");
        if (100 - accuracy <= 1.15 * errors)
            continue;
        add("names");
        errors = 100 - accuracy;
    }
    return {"accuracy_and_time",
            fmt::format("Test accuracy over {} splits against time per frame on one core; bars are "
                        "standard deviations. The paper's figures are of its own images and machine.",
                        name_of(rule)),
            points.empty() ? "" : csv_of(points)};
}

/// Accuracy against the number of tactels, of methods that were tried at several sizes.
study_picture sizes_picture(const std::vector<study_row>& rows) {
    const split_rule rule = shown_rule(rows);
    std::map<std::string, std::map<std::size_t, nlohmann::ordered_json>> methods; // by tactels
    for (const study_row& row : rows)
        if (const auto* a = find_accuracy(row, rule)) {
            const std::string name = fmt::format("{} {}", method_title(row), row.recipe);
            methods[name][row.rows * row.columns] =
                point(name, static_cast<double>(row.rows * row.columns), 100 * a->test.mean,
                      100 * a->test.deviation, words_of(row));
        }
    std::erase_if(methods, [](const auto& method) { return method.second.size() < 2; });
    if (methods.empty())
        return {};
    if (has_paper(rows))
        for (const published_result& p : published_results)
            if (p.method == "tactnet6")
                methods["TactNet-6 in the paper"][p.rows * p.columns] =
                    point("TactNet-6 in the paper", static_cast<double>(p.rows * p.columns), p.accuracy,
                          p.deviation, "");
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

std::vector<std::pair<std::string, std::string>>
draw_study_pictures(const std::vector<study_picture>& pictures, const std::filesystem::path& folder) {
    std::vector<std::pair<std::string, std::string>> drawn;
    for (const study_picture& picture : pictures) {
        const std::string script = picture.name + ".gnuplot";
        draw_picture(script, folder / picture.name, picture.csv, {.names = picture.series});
        drawn.emplace_back(
            picture.caption,
            draw(script, folder / (picture.name + ".csv"), "svg", {.names = picture.series}).picture);
    }
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
