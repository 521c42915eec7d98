#include "study/rows.hpp"

#include "methods/training_settings.hpp"
#include "reports/report.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace {

std::optional<calibration> together(std::span<const calibration> splits) {
    if (splits.empty())
        return std::nullopt;
    calibration all{{0}};
    for (const calibration& each : splits) {
        all.scaling.temperature += each.scaling.temperature / static_cast<double>(splits.size());
        all.before.add(each.before);
        all.after.add(each.after);
    }
    return all;
}

split_accuracies accuracies_of(const candidate& c, tactnet::split_rule rule, const std::vector<task>& tasks,
                               const result_list& results, std::size_t wanted, study_row& row) {
    std::vector<double> test, validation, training, reflected;
    std::vector<calibration> calibrations;
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
        row.seconds = row.seconds > 0 ? std::min(row.seconds, r->seconds) : r->seconds;
        if (row.accuracies.empty()) { // of the first rule that has any
            row.confusion.add(r->confusion);
            if (r->calibration)
                calibrations.push_back(*r->calibration);
            add_means(row.decisions, r->decisions);
        }
    }
    if (row.accuracies.empty())
        row.probabilities = together(calibrations);
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
    const auto put = [&](const std::string& name, bool known, auto value) {
        object[name] = known ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
    };
    for (const tactnet::split_rule rule : {tactnet::split_rule::random, tactnet::split_rule::blocked}) {
        const split_accuracies* const found = find_accuracy(row, rule);
        const split_accuracies a = found != nullptr ? *found : split_accuracies{rule, 0, 0, {}, 0, 0};
        const bool known = found != nullptr, reflected = a.reflected_splits > 0;
        const std::string of = fmt::format("{}_", name_of(rule));
        put(of + "splits", known, a.splits);
        put(of + "splits_wanted", known, a.wanted);
        put(of + "accuracy", known, a.test.mean);
        put(of + "deviation", known, a.test.deviation);
        put(of + "validation_accuracy", known, a.validation);
        put(of + "training_accuracy", known, a.training);
        put(of + "reflected_splits", known, a.reflected_splits);
        put(of + "reflected_accuracy", reflected, a.reflected.mean);
        put(of + "reflected_deviation", reflected, a.reflected.deviation);
    }
    const bool timed = row.latency.has_value(), costs = row.costs.parameters > 0;
    const frame_latency latency = row.latency.value_or(frame_latency{});
    put("microseconds", timed, latency.median);
    put("microseconds_p99", timed, latency.p99);
    put("microseconds_in_batch", timed, latency.in_batch);
    put("jitter", timed, latency.jitter);
    put("training_seconds", !row.accuracies.empty(), row.seconds);
    put("parameters", costs, row.costs.parameters);
    put("multiply_adds", costs, row.costs.multiply_adds);
    put("multiply_adds_on_pixels", costs, row.costs.multiply_adds_on_pixels);
    put("bytes", costs, row.costs.parameter_bytes);
    put("activation_bytes", row.costs.activation_bytes > 0, row.costs.activation_bytes);
    const published_result paper = row.published != nullptr ? *row.published : published_result{};
    put("published_accuracy", row.published != nullptr, paper.accuracy / 100);
    put("published_deviation", row.published != nullptr, paper.deviation / 100);
    put("published_microseconds", paper.seconds > 0, 1e6 * paper.seconds);
    const bool calibrated = row.probabilities.has_value();
    const calibration probabilities = row.probabilities.value_or(calibration{});
    put("temperature", calibrated, probabilities.scaling.temperature);
    put("softmax_calibration_error", calibrated, probabilities.before.calibration_error());
    put("softmax_brier_score", calibrated, probabilities.before.brier_score());
    put("calibration_error", calibrated, probabilities.after.calibration_error());
    put("brier_score", calibrated, probabilities.after.brier_score());
    for (const decision_column& column : decision_columns) {
        const auto found = row.decisions.find(std::string(column.name));
        const bool measured = found != row.decisions.end();
        put(std::string(column.name), measured, measured ? found->second.value() : 0);
    }
    object["declaration"] = row.declaration;
    object["missing"] = row.missing;
    return object;
}

study_row row_of(const candidate& c, std::size_t bits, const split_plan& plan, const std::vector<task>& tasks,
                 const result_list& results) {
    const method& what = *c.what;
    study_row row{.method = what.name,
                  .rows = what.rows,
                  .columns = what.columns,
                  .recipe = std::string(recipe_for(what, c.training).name),
                  .bits = bits};
    row.classes = c.data->images.classes;
    row.confusion = tactnet::confusion_matrix(row.classes.size());
    for (const tactnet::split_rule rule : plan.rules)
        if (split_accuracies found = accuracies_of(c, rule, tasks, results, plan.splits, row);
            found.splits > 0)
            row.accuracies.push_back(std::move(found));
    row.costs = what.costs(row.classes.size());
    if (bits == 8) {
        row.costs.parameter_bytes = what.eight_bit_bytes(row.classes.size());
        row.costs.activation_bytes = 0; // unknown
    }
    row.family = !what.is_network()  ? method_family::machines
                 : what.pretrained() ? method_family::photographs
                                     : method_family::touches;
    row.declaration = what.declaration();
    // For the network as it was published, not for a user's of that name.
    if (bits == 32 && (row.declaration.empty() || row.declaration.starts_with("tactnet::")))
        row.published = find_published(row.method, row.rows, row.columns);
    if (row.accuracies.empty())
        row.missing = "not trained yet";
    return row;
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

std::vector<study_row> rows_of(const candidate_list& candidates, const split_plan& plan,
                               const std::vector<task>& tasks, const result_list& results,
                               const time_of_method& time) {
    std::vector<study_row> rows;
    for (const candidate& c : candidates)
        for (const std::size_t bits : bits_of(c)) {
            rows.push_back(row_of(c, bits, plan, tasks, results));
            rows.back().latency = time(*c.what, bits);
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

const study_row* most_accurate(const std::vector<study_row>& rows, tactnet::split_rule rule) {
    const study_row* best = nullptr;
    for (const study_row& row : rows)
        if (const auto* a = find_accuracy(row, rule))
            if (best == nullptr || a->test.mean > find_accuracy(*best, rule)->test.mean)
                best = &row;
    return best;
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
