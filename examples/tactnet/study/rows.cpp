#include "study/rows.hpp"

#include "methods/training_settings.hpp"
#include "reports/report.hpp"
#include "study/plan.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace {

split_accuracies accuracies_of(const candidate& c, tactnet::split_rule rule, const std::vector<task>& tasks,
                               const result_list& results, std::size_t wanted, study_row& row,
                               std::vector<double>& seconds) {
    std::vector<double> test, validation, training, reflected;
    std::vector<std::vector<tactnet::epoch_report>> curves;
    const auto keep = [](std::vector<double>& list, double value) {
        if (std::isfinite(value))
            list.push_back(value);
    };
    for (const task& t : tasks) {
        if (t.of != &c || t.rule != rule)
            continue;
        const training_result* r = results.find(row.bits == 8 ? t.settings : in_single_precision(t.settings));
        if (r == nullptr)
            continue;
        if (r->confusion.classes() != row.classes.size())
            throw tactnet::file_error("evaluation.jsonl", title_of(row),
                                      fmt::format("results of {} classes", row.classes.size()),
                                      fmt::to_string(r->confusion.classes()));
        keep(test, r->confusion.accuracy());
        keep(validation, r->validation_accuracy);
        keep(training, r->training_accuracy);
        keep(reflected, r->reflected_accuracy);
        seconds.push_back(r->seconds);
        if (row.accuracies.empty()) // of the first rule that has any
            row.confusion.add(r->confusion);
        curves.push_back(r->curve);
    }
    if (row.accuracies.empty())
        row.curve = mean_curve(curves);
    const auto mean_of = [](const std::vector<double>& values) {
        return values.empty() ? std::nan("") : tactnet::mean_and_deviation::of(values).mean;
    };
    return {rule,
            test.size(),
            wanted,
            tactnet::mean_and_deviation::of(test),
            mean_of(validation),
            mean_of(training),
            tactnet::mean_and_deviation::of(reflected),
            reflected.size()};
}

nlohmann::ordered_json json_of(const study_row& row) {
    nlohmann::ordered_json object{{"method", row.method},
                                  {"rows", row.rows},
                                  {"columns", row.columns},
                                  {"recipe", row.recipe},
                                  {"bits", row.bits}};
    for (const tactnet::split_rule rule : {tactnet::split_rule::random, tactnet::split_rule::blocked}) {
        const split_accuracies* found = find_accuracy(row, rule);
        const auto put = [&](const char* what, auto value) {
            auto& entry = object[fmt::format("{}_{}", name_of(rule), what)];
            if (found != nullptr)
                entry = value(*found);
        };
        put("splits", [](const auto& a) { return a.splits; });
        put("splits_wanted", [](const auto& a) { return a.wanted; });
        put("accuracy", [](const auto& a) { return a.test.mean; });
        put("deviation", [](const auto& a) { return a.test.deviation; });
        put("validation_accuracy", [](const auto& a) { return a.validation; });
        put("training_accuracy", [](const auto& a) { return a.training; });
        const auto if_reflected = [](const split_accuracies& a, double value) {
            return a.reflected_splits > 0 ? value : std::nan("");
        };
        put("reflected_splits", [](const auto& a) { return a.reflected_splits; });
        put("reflected_accuracy", [&](const auto& a) { return if_reflected(a, a.reflected.mean); });
        put("reflected_deviation", [&](const auto& a) { return if_reflected(a, a.reflected.deviation); });
    }
    const auto number = [&](const char* name, bool known, auto value) {
        object[name] = known ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
    };
    const bool timed = row.latency.has_value(), costs = row.costs.parameters > 0;
    const frame_latency latency = row.latency.value_or(frame_latency{});
    number("microseconds", timed, latency.median);
    number("microseconds_p99", timed, latency.p99);
    number("microseconds_in_batch", timed, latency.in_batch);
    number("jitter", timed, latency.jitter);
    number("training_seconds", !row.accuracies.empty(), row.seconds);
    number("parameters", costs, row.costs.parameters);
    number("multiply_adds", costs, row.costs.multiply_adds);
    number("multiply_adds_on_pixels", costs, row.costs.multiply_adds_on_pixels);
    number("bytes", costs, row.costs.parameter_bytes);
    number("code_bytes", row.code_bytes > 0, row.code_bytes);
    number("activation_bytes", row.costs.activation_bytes > 0, row.costs.activation_bytes);
    const bool published = row.published != nullptr;
    number("published_accuracy", published, published ? row.published->accuracy / 100 : 0);
    number("published_deviation", published, published ? row.published->deviation / 100 : 0);
    number("published_microseconds", published && row.published->seconds > 0,
           published ? 1e6 * row.published->seconds : 0);
    object["declaration"] = row.declaration;
    object["missing"] = row.missing;
    return object;
}

study_row row_of(const candidate& c, std::size_t bits, const split_plan& plan, const std::vector<task>& tasks,
                 const result_list& results, const timing_list& timings) {
    const method& what = *c.what;
    study_row row{.method = what.name,
                  .rows = what.rows,
                  .columns = what.columns,
                  .recipe = std::string(recipe_for(what, c.training).name),
                  .bits = bits};
    row.classes = c.data->images.classes;
    row.confusion = tactnet::confusion_matrix(row.classes.size());
    std::vector<double> seconds;
    for (const tactnet::split_rule rule : plan.rules)
        if (split_accuracies found = accuracies_of(c, rule, tasks, results, plan.splits, row, seconds);
            found.splits > 0)
            row.accuracies.push_back(std::move(found));
    if (!seconds.empty())
        row.seconds = std::ranges::min(seconds);
    if (const frame_latency* found = timings.find(what, bits))
        row.latency = *found;
    row.by_instruction_set = timings.by_instruction_set(what, bits);
    row.costs = what.costs(row.classes.size());
    if (bits == 8) {
        row.costs.parameter_bytes = what.eight_bit_bytes(row.classes.size());
        row.costs.activation_bytes = 0; // nobody says
    }
    row.family = !what.is_network()  ? method_family::machines
                 : what.pretrained() ? method_family::photographs
                                     : method_family::touches;
    row.declaration = what.declaration();
    // Of the network as it was published, not of a user's of that name.
    if (bits == 32 && (row.declaration.empty() || row.declaration.starts_with("tactnet::")))
        row.published = find_published(row.method, row.rows, row.columns);
    if (row.accuracies.empty())
        row.missing = "not trained yet";
    return row;
}

std::string percent(const split_accuracies* a) {
    if (a == nullptr)
        return "";
    const std::string text = fmt::format("{:.2f} ± {:.2f}", 100 * a->test.mean, 100 * a->test.deviation);
    return a->splits == a->wanted ? text : fmt::format("{} ({} of {})", text, a->splits, a->wanted);
}

} // namespace

const split_accuracies* find_accuracy(const study_row& row, tactnet::split_rule rule) {
    const auto found = std::ranges::find(row.accuracies, rule, &split_accuracies::rule);
    return found == row.accuracies.end() ? nullptr : &*found;
}

std::string method_title(const study_row& row) {
    return row.method + (row.bits == 8 ? " in 8 bits" : "");
}

std::string title_of(const study_row& row) {
    return fmt::format("{} {}x{}{}", method_title(row), row.rows, row.columns,
                       row.recipe == "default" ? "" : ", " + row.recipe);
}

std::vector<tactnet::epoch_report>
mean_curve(const std::vector<std::vector<tactnet::epoch_report>>& trainings) {
    std::map<std::size_t, std::vector<const tactnet::epoch_report*>> by_epoch;
    for (const auto& curve : trainings)
        for (const tactnet::epoch_report& e : curve)
            by_epoch[e.epoch].push_back(&e);
    std::vector<tactnet::epoch_report> means;
    for (const auto& [epoch, reports] : by_epoch) {
        const auto at_work = std::ranges::count_if(trainings, [epoch = epoch](const auto& curve) {
            return !curve.empty() && curve.back().epoch >= epoch;
        });
        if (std::ssize(reports) != at_work)
            continue;
        tactnet::epoch_report mean{.epoch = epoch, .validation_loss = 0, .validation_accuracy = 0};
        for (const tactnet::epoch_report* e : reports) {
            mean.loss += e->loss / static_cast<double>(reports.size());
            mean.validation_loss += e->validation_loss / static_cast<double>(reports.size());
            mean.validation_accuracy += e->validation_accuracy / static_cast<double>(reports.size());
        }
        means.push_back(mean);
    }
    return means;
}

std::vector<study_row> rows_of(const candidate_list& candidates, const split_plan& plan,
                               const std::vector<task>& tasks, const result_list& results,
                               const timing_list& timings, const std::vector<code_size>& code) {
    std::vector<study_row> rows;
    for (const candidate& c : candidates)
        for (const std::size_t bits : bits_of(c)) {
            study_row& row = rows.emplace_back(row_of(c, bits, plan, tasks, results, timings));
            for (const code_size& size : code)
                if (size.method == row.method && size.rows == row.rows && size.columns == row.columns &&
                    size.bits == bits)
                    row.code_bytes = size.bytes;
        }
    return rows;
}

tactnet::split_rule shown_rule(const std::vector<study_row>& rows) {
    return std::ranges::any_of(rows,
                               [](const study_row& row) {
                                   return find_accuracy(row, tactnet::split_rule::random) != nullptr;
                               })
               ? tactnet::split_rule::random
               : tactnet::split_rule::blocked;
}

std::vector<const study_row*> pareto_front(const std::vector<study_row>& rows, tactnet::split_rule rule) {
    std::vector<const study_row*> known, front;
    for (const study_row& row : rows)
        if (const auto* a = find_accuracy(row, rule); row.latency && a != nullptr && a->splits == a->wanted)
            known.push_back(&row);
    std::ranges::stable_sort(known, [&](const study_row* a, const study_row* b) {
        return a->latency->median != b->latency->median
                   ? a->latency->median < b->latency->median
                   : find_accuracy(*a, rule)->test.mean > find_accuracy(*b, rule)->test.mean;
    });
    double best = -1;
    for (const study_row* row : known)
        if (const double accuracy = find_accuracy(*row, rule)->test.mean; accuracy > best) {
            best = accuracy;
            front.push_back(row);
        }
    return front;
}

std::string study_table(const std::vector<study_row>& rows) {
    std::vector<std::vector<std::string>> cells{{"method", "size", "recipe", "random, %", "blocked, %",
                                                 "paper, %", "µs/frame", "p99", "in batch", "parameters",
                                                 "training, s"}};
    std::string reasons;
    for (const study_row& row : rows) {
        const auto time = [&](double frame_latency::*what) {
            return row.latency ? fmt::format("{:.1f}", (*row.latency).*what) : "";
        };
        cells.push_back(
            {method_title(row), fmt::format("{}x{}", row.rows, row.columns), row.recipe,
             percent(find_accuracy(row, tactnet::split_rule::random)),
             percent(find_accuracy(row, tactnet::split_rule::blocked)),
             row.published == nullptr
                 ? ""
                 : fmt::format("{:.2f} ± {:.2f}", row.published->accuracy, row.published->deviation),
             time(&frame_latency::median), time(&frame_latency::p99), time(&frame_latency::in_batch),
             row.costs.parameters > 0 ? grouped(row.costs.parameters) : "",
             row.accuracies.empty() ? "" : fmt::format("{:.1f}", row.seconds)});
        if (!row.missing.empty())
            reasons += fmt::format("{}: {}\n", title_of(row), row.missing);
    }
    return table(cells) + reasons;
}

std::string study_json_lines(const std::vector<study_row>& rows) {
    std::string lines;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        nlohmann::ordered_json object = json_of(rows[i]);
        object["line"] = i + 1; // a file that lost some would otherwise be as good as a whole one
        object["lines"] = rows.size();
        lines += tactnet::with_checksum(object.dump()) + '\n';
    }
    return lines;
}

std::string study_csv(const std::vector<study_row>& rows) {
    std::vector<nlohmann::ordered_json> objects;
    for (const study_row& row : rows)
        objects.push_back(json_of(row));
    return csv_of(objects);
}
