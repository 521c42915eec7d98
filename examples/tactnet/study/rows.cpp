#include "study/rows.hpp"

#include "console.hpp"
#include "reports/report.hpp"
#include "study/published.hpp"

#include <tactnet/io/safetensors/json_checksum.hpp>
#include <tactnet/io/write_file.hpp>

#include <cmath>

namespace {

using tactnet::split_rule;

std::string member(split_rule rule, std::string_view name) {
    std::string text = fmt::format("{}_{}", name_of(rule), name);
    std::ranges::replace(text, '-', '_');
    return text;
}

/// The members of a rule, of which nothing is known.
void put_rule(study_row& row, split_rule rule) {
    for (const char* name :
         {"splits", "splits_wanted", "accuracy", "deviation", "validation_accuracy", "training_accuracy",
          "reflected_splits", "reflected_accuracy", "reflected_deviation"})
        row.values[member(rule, name)] = nullptr;
}

/// The results of a candidate on splits by a rule.
std::vector<const training_result*> results_of(const candidate& c, split_rule rule, std::size_t bits,
                                               const std::vector<task>& tasks, const result_list& results) {
    std::vector<const training_result*> found;
    const std::size_t classes = c.data->images.classes.size();
    for (const task& t : tasks) {
        if (t.of != &c || t.rule != rule)
            continue;
        const training_result* r = results.find(bits == 8 ? t.settings : in_single_precision(t.settings));
        if (r == nullptr)
            continue;
        if (r->confusion.classes() != classes)
            refuse("evaluation.jsonl: {}: expected results of {} classes, found {}", c.what->name, classes,
                   r->confusion.classes());
        found.push_back(r);
    }
    return found;
}

/// Means over the splits that have such a value, and for those that are compared how many and their
/// deviation.
void put_accuracies(study_row& row, split_rule rule, const std::vector<const training_result*>& all,
                    std::size_t wanted) {
    row.values[member(rule, "splits_wanted")] = wanted;
    using accuracy = double (*)(const training_result&);
    for (const auto& [kind, accuracy_of] :
         {std::pair<std::string, accuracy>{"", [](const auto& r) { return r.confusion.accuracy(); }},
          {"validation_", [](const auto& r) { return r.validation_accuracy; }},
          {"training_", [](const auto& r) { return r.training_accuracy; }},
          {"reflected_", [](const auto& r) { return r.reflected_accuracy; }}}) {
        std::vector<double> known;
        for (const training_result* r : all)
            if (const double found = accuracy_of(*r); std::isfinite(found))
                known.push_back(found);
        const auto [mean, deviation] = known.empty() ? tactnet::mean_and_deviation{std::nan(""), std::nan("")}
                                                     : tactnet::mean_and_deviation::of(known);
        row.values[member(rule, kind + "accuracy")] = mean;
        if (const std::string splits = member(rule, kind + "splits"); row.values.contains(splits)) {
            row.values[splits] = known.size();
            row.values[member(rule, kind + "deviation")] = deviation;
        }
    }
}

/// What the trainings on the first kind of splits that has any have in common.
void put_together(study_row& row, const std::vector<const training_result*>& all) {
    const auto calibrated = static_cast<double>(
        std::ranges::count_if(all, [](const auto* r) { return r->calibration.has_value(); }));
    calibration together{{0}};
    row.confusion = tactnet::confusion_matrix(row.classes.size());
    for (const training_result* r : all) {
        row.confusion.add(r->confusion);
        if (r->calibration) {
            together.scaling.temperature += r->calibration->scaling.temperature / calibrated;
            together.before.add(r->calibration->before);
            together.after.add(r->calibration->after);
        }
    }
    if (calibrated > 0)
        put_calibration(row, together);
}

study_row row_of(const candidate& c, std::size_t bits, const split_plan& plan, const std::vector<task>& tasks,
                 const result_list& results) {
    const method& what = *c.what;
    study_row row =
        make_row(what.name, what.rows, what.columns, std::string(recipe_for(what, c.training).name), bits);
    nlohmann::ordered_json& values = row.values;
    row.classes = c.data->images.classes;
    for (const split_rule rule : plan.rules) {
        put_rule(row, rule);
        const auto found = results_of(c, rule, bits, tasks, results);
        if (found.empty())
            continue;
        if (row.confusion.classes() == 0)
            put_together(row, found);
        put_accuracies(row, rule, found, plan.splits);
        for (const training_result* r : found) // of the quickest, since others may have shared the machine
            values["training_seconds"] = std::fmin(number(row, "training_seconds"), r->seconds);
    }
    const method_costs costs = what.costs(row.classes.size());
    values["parameters"] = costs.parameters;
    values["multiply_adds"] = costs.multiply_adds;
    values["multiply_adds_on_pixels"] = costs.multiply_adds_on_pixels;
    values["bytes"] = bits == 8 ? what.eight_bit_bytes(row.classes.size()) : costs.parameter_bytes;
    if (bits == 32)
        values["activation_bytes"] = costs.activation_bytes;
    row.family = !what.is_network() ? "machines" : what.pretrained() ? "photographs" : "touches";
    const std::string declaration = what.declaration(row.classes.size());
    values["declaration"] = declaration;
    const published_result* const paper =
        c.data->of_paper() ? find_published(what.name, what.rows, what.columns) : nullptr;
    // For the network as it was published, not for a user's of that name.
    if (paper != nullptr && bits == 32 && (declaration.empty() || declaration.starts_with("tactnet::"))) {
        values["published_accuracy"] = paper->accuracy / 100;
        values["published_deviation"] = paper->deviation / 100;
        if (paper->seconds > 0)
            values["published_microseconds"] = 1e6 * paper->seconds;
    }
    return row;
}

} // namespace

study_row make_row(const std::string& method, std::size_t rows, std::size_t columns,
                   const std::string& recipe, std::size_t bits) {
    study_row row{
        {{"method", method}, {"rows", rows}, {"columns", columns}, {"recipe", recipe}, {"bits", bits}}, {}};
    for (const split_rule rule : {split_rule::random, split_rule::blocked})
        put_rule(row, rule);
    for (const char* name :
         {"microseconds", "microseconds_p99", "microseconds_in_batch", "jitter", "training_seconds",
          "parameters", "multiply_adds", "multiply_adds_on_pixels", "bytes", "activation_bytes",
          "published_accuracy", "published_deviation", "published_microseconds", "temperature",
          "softmax_calibration_error", "softmax_brier_score", "calibration_error", "brier_score"})
        row.values[name] = nullptr;
    row.values["declaration"] = "";
    return row;
}

std::string text(const study_row& row, std::string_view name) {
    return row.values.at(std::string(name)).get<std::string>();
}

double number(const study_row& row, std::string_view name) {
    const auto value = row.values.find(std::string(name)); // rules that were not asked for are in no row
    return value == row.values.end() || value->is_null() ? std::nan("") : value->get<double>();
}

double number(const study_row& row, split_rule rule, std::string_view name) {
    return number(row, member(rule, name));
}

std::string method_title(const study_row& row) {
    return text(row, "method") + (number(row, "bits") == 8 ? " in 8 bits" : "");
}

std::string title_of(const study_row& row) {
    const std::string recipe = text(row, "recipe");
    return fmt::format("{} {}x{}{}", method_title(row), number(row, "rows"), number(row, "columns"),
                       recipe == "default" ? "" : ", " + recipe);
}

std::vector<study_row> rows_of(const candidate_list& candidates, const split_plan& plan,
                               const std::vector<task>& tasks, const result_list& results,
                               const time_of_method& time) {
    std::vector<study_row> rows;
    for (const candidate& c : candidates)
        for (const std::size_t bits : bits_of(c)) {
            nlohmann::ordered_json& values = rows.emplace_back(row_of(c, bits, plan, tasks, results)).values;
            if (const auto found = time(*c.what, bits)) {
                values["microseconds"] = found->median;
                values["microseconds_p99"] = found->p99;
                values["microseconds_in_batch"] = found->in_batch;
                values["jitter"] = found->jitter;
            }
        }
    return rows;
}

void put_calibration(study_row& row, const calibration& of) {
    row.values["temperature"] = of.scaling.temperature;
    row.values["softmax_calibration_error"] = of.before.calibration_error();
    row.values["softmax_brier_score"] = of.before.brier_score();
    row.values["calibration_error"] = of.after.calibration_error();
    row.values["brier_score"] = of.after.brier_score();
    row.probabilities = of;
}

split_rule shown_rule(const std::vector<study_row>& rows) {
    for (const auto& [name, rule] : split_rule_names)
        if (std::ranges::any_of(
                rows, [&](const study_row& row) { return std::isfinite(number(row, rule, "accuracy")); }))
            return rule;
    return split_rule::blocked;
}

std::vector<study_row> pareto_front(const std::vector<study_row>& rows, split_rule rule) {
    std::vector<study_row> known = rows;
    std::erase_if(known, [&](const study_row& row) {
        return !std::isfinite(number(row, "microseconds")) ||
               !(number(row, rule, "splits") == number(row, rule, "splits_wanted")); // also of NaN
    });
    std::ranges::stable_sort(known, {}, [&](const study_row& row) {
        return std::pair(number(row, "microseconds"), -number(row, rule, "accuracy"));
    });
    std::vector<study_row> front;
    for (const study_row& row : known)
        if (front.empty() || number(row, rule, "accuracy") > number(front.back(), rule, "accuracy"))
            front.push_back(row);
    return front;
}

const study_row* most_accurate(const std::vector<study_row>& rows, split_rule rule) {
    const auto accuracy = [&](const study_row& row) {
        return std::fmax(number(row, rule, "accuracy"), -1); // -1 for NaN
    };
    const auto best = std::ranges::max_element(rows, {}, accuracy);
    return best == rows.end() || accuracy(*best) < 0 ? nullptr : &*best;
}

void write_rows(const std::vector<study_row>& rows, const std::filesystem::path& folder,
                const std::string& name) {
    std::string lines;
    std::vector<nlohmann::ordered_json> all;
    for (const study_row& row : rows) {
        nlohmann::ordered_json line = all.emplace_back(row.values);
        line["line"] = all.size(); // a file that lost some would otherwise be as good as a whole one
        line["lines"] = rows.size();
        lines += tactnet::with_checksum(line.dump()) + '\n';
    }
    tactnet::write_file(folder / (name + ".jsonl"), lines);
    tactnet::write_file(folder / (name + ".csv"), csv_of(all));
}
