#include "study/comparison.hpp"

#include "console.hpp"
#include "methods/description.hpp"
#include "reports/pictures.hpp"
#include "reports/report.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/training/intervals.hpp>

#include <algorithm>
#include <cmath>

void report_intervals(const candidate_list& candidates, const split_plan& plan,
                      const std::vector<task>& tasks, const result_list& results) {
    table_cells cells{{"method", "tactels", "splits", "accuracy, %", "95 % interval", "balanced, %",
                       "to the first, points", "95 % interval", "by chance"}};
    std::vector<nlohmann::ordered_json> rows;
    for (const tactnet::split_rule rule : plan.rules) {
        std::vector<double> first;
        for (const candidate& c : candidates) {
            std::vector<double> accuracies;
            tactnet::confusion_matrix all(c.data->images.classes.size());
            for (const task& t : tasks)
                if (const training_result* found =
                        t.of == &c && t.rule == rule ? results.find(t.settings) : nullptr) {
                    accuracies.push_back(found->confusion.accuracy());
                    all.add(found->confusion);
                }
            if (accuracies.size() < 2)
                continue;
            const double tested = static_cast<double>(all.total()) / static_cast<double>(accuracies.size());
            const double ratio = tested / (static_cast<double>(c.data->images.size()) - tested);
            const auto interval = [](const tactnet::mean_interval& of) {
                return fmt::format("{:.2f} to {:.2f}", 100 * of.low, 100 * of.high);
            };
            auto alone = tactnet::mean_interval::of(accuracies, ratio);
            alone.low = std::fmax(alone.low, 0), alone.high = std::fmin(alone.high, 1);
            nlohmann::ordered_json& row = rows.emplace_back();
            row = {{"method", c.what->name},
                   {"rows", c.what->rows},
                   {"columns", c.what->columns},
                   {"split", name_of(rule)},
                   {"splits", accuracies.size()},
                   {"accuracy", alone.mean},
                   {"low", alone.low},
                   {"high", alone.high},
                   {"balanced_accuracy", all.balanced_accuracy()}};
            for (const char* name : {"to_first", "to_first_low", "to_first_high", "probability"})
                row[name] = nullptr;
            cells.push_back({c.what->name, c.what->size(),
                             fmt::format("{} {}", accuracies.size(), name_of(rule)),
                             fmt::format("{:.2f}", 100 * alone.mean), interval(alone),
                             fmt::format("{:.2f}", 100 * all.balanced_accuracy()), "", "", ""});
            if (first.size() == accuracies.size()) {
                const auto both = tactnet::mean_interval::of_differences(accuracies, first, ratio);
                cells.back()[6] = fmt::format("{:+.2f}", 100 * both.mean);
                row["to_first"] = both.mean, row["probability"] = both.probability;
                row["to_first_low"] = both.low, row["to_first_high"] = both.high;
                cells.back()[7] = interval(both), cells.back()[8] = fmt::format("{:.3f}", both.probability);
            }
            if (first.empty())
                first = accuracies;
        }
    }
    write_lines(results.path().parent_path() / "intervals", rows);
    if (cells.size() > 1)
        print(table(without_empty_columns(cells)) +
              "95 % interval: of the mean over splits, wider for the images that splits have in common; "
              "by chance: the probability of such a difference between methods that are alike\n\n");
}

void report_learning_curve(const std::vector<const candidate*>& candidates, const split_plan& plan,
                           const std::vector<task>& tasks, const result_list& results) {
    table_cells cells{{"method", "tactels", "split", "share, %", "training images", "accuracy, %", "splits"}};
    std::vector<nlohmann::ordered_json> points;
    std::vector<std::string> series;
    for (const tactnet::split_rule rule : plan.rules)
        for (const candidate* of : candidates) {
            const candidate& c = *of;
            const std::string name =
                fmt::format("{} {} {}", c.what->name, c.what->size(), name_of(rule)); // no comma: gnuplot
            if (std::ranges::find(series, name) == series.end())
                series.push_back(name);
            training_settings counted = c.training;
            counted.balance = false; // which repeats images
            std::vector<double> accuracies;
            double images = 0;
            for (const task& t : tasks)
                if (const training_result* found =
                        t.of == &c && t.rule == rule ? results.find(t.settings) : nullptr) {
                    accuracies.push_back(100 * found->confusion.accuracy());
                    images += static_cast<double>(split_for(*c.data, counted, rule, t.seed).training.size());
                }
            if (accuracies.empty())
                continue;
            images /= static_cast<double>(accuracies.size());
            const auto [mean, deviation] = tactnet::mean_and_deviation::of(accuracies);
            points.push_back({{"series", name},
                              {"x", images},
                              {"accuracy", mean},
                              {"deviation", accuracies.size() > 1 ? deviation : 0},
                              {"share", c.training.share},
                              {"splits", accuracies.size()}});
            cells.push_back({c.what->name, c.what->size(), std::string(name_of(rule)),
                             fmt::format("{:g}", 100 * c.training.share), fmt::format("{:.0f}", images),
                             fmt::format("{:.2f} ± {:.2f}", mean, deviation),
                             fmt::to_string(accuracies.size())});
        }
    draw_picture("accuracy_and_images", results.path().parent_path() / "learning_curve", csv_of(points),
                 "Accuracy on the same test images", series);
    print(table(cells) + '\n');
}

std::size_t write_predictions(const std::filesystem::path& file, const candidate& of, std::size_t bits,
                              const std::vector<task>& tasks) {
    std::string text;
    std::size_t missing = 0;
    for (const task& t : tasks) {
        const auto path = predictions_of(of, bits == 8 ? t.settings : in_single_precision(t.settings));
        if (t.of != &of || (!std::filesystem::exists(path) && ++missing > 0))
            continue;
        const auto bytes = tactnet::read_file(path);
        const std::string_view lines(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        text += text.empty() ? lines : lines.substr(std::min(lines.find('\n'), lines.size() - 1) + 1);
    }
    tactnet::write_file(file, text);
    return missing;
}
