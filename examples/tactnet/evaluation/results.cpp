#include "evaluation/results.hpp"

#include <tactnet/decision/fitting.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

namespace {

using nlohmann::json;

json number_or_null(double value) {
    return std::isfinite(value) ? json(value) : json(nullptr);
}

/// Four digits are enough for a picture.
json rounded_or_null(double value) {
    return std::isfinite(value) ? json(std::stod(fmt::format("{:.4g}", value))) : json(nullptr);
}

json bins_of(const tactnet::reliability_diagram& diagram) {
    json bins = json::array();
    for (const auto& [count, right, probability, squares] : diagram.bins())
        bins.push_back({count, right, probability, squares});
    return bins;
}

std::string line_of(const training_result& r) {
    std::vector<std::size_t> counts;
    for (std::size_t truth = 0; truth < r.confusion.classes(); ++truth)
        for (std::size_t c = 0; c < r.confusion.classes(); ++c)
            counts.push_back(r.confusion.count(truth, c));
    nlohmann::ordered_json line;
    line["settings"] = r.settings;
    line["accuracy"] = r.confusion.accuracy();
    line["validation_accuracy"] = number_or_null(r.validation_accuracy);
    line["training_accuracy"] = number_or_null(r.training_accuracy);
    line["reflected_accuracy"] = number_or_null(r.reflected_accuracy);
    line["epochs"] = r.epochs;
    line["seconds"] = r.seconds;
    line["classes"] = r.confusion.classes();
    line["confusion"] = counts;
    if (r.calibration)
        line["calibration"] = {{"temperature", r.calibration->scaling.temperature},
                               {"before", bins_of(r.calibration->before)},
                               {"after", bins_of(r.calibration->after)}};
    for (const auto& [name, mean] : r.decisions)
        line["decisions"][name] = {mean.sum, mean.count};
    for (const tactnet::epoch_report& e : r.curve)
        line["curve"].push_back({e.epoch, rounded_or_null(e.loss), rounded_or_null(e.validation_loss),
                                 rounded_or_null(e.validation_accuracy)});
    return line.dump();
}

/// nlohmann::json turns any number into the type that is asked for.
std::size_t count_in(const json& value) {
    if (!value.is_number_unsigned())
        throw std::runtime_error("expected a whole number from 0, found " + value.dump());
    return value.get<std::size_t>();
}

double number_in(const json& value) {
    return value.is_null() ? std::nan("") : value.get<double>();
}

tactnet::reliability_diagram diagram_in(const json& list) {
    std::array<tactnet::reliability_diagram::bin, tactnet::reliability_diagram::bin_count> bins;
    if (!list.is_array() || list.size() != bins.size())
        throw std::runtime_error(fmt::format("expected {} bins of probabilities", bins.size()));
    for (std::size_t b = 0; b < bins.size(); ++b) {
        bins[b] = {count_in(list[b].at(0)), count_in(list[b].at(1)), list[b].at(2), list[b].at(3)};
        const auto count = static_cast<double>(bins[b].count);
        const auto holds = [&](double sum) { return sum >= 0 && sum <= count * (1 + 1e-5); };
        if (bins[b].right > bins[b].count || !holds(bins[b].probability) || !holds(bins[b].squares))
            throw std::runtime_error("expected sums within the count of a bin, found " + list[b].dump());
    }
    return tactnet::reliability_diagram(bins);
}

calibration calibration_in(const json& object) {
    const double temperature = object.at("temperature");
    if (!(temperature > 0 && std::isfinite(temperature)))
        throw std::runtime_error("expected a temperature above 0, found " + object.at("temperature").dump());
    return {{temperature}, diagram_in(object.at("before")), diagram_in(object.at("after"))};
}

decision_means decisions_in(const json& object) {
    decision_means means;
    for (const auto& [name, mean] : object.items()) {
        const bool numbers =
            mean.is_array() && mean.size() == 2 && mean[0].is_number() && mean[1].is_number();
        if (!numbers || !(mean[0] >= 0) || !(mean[1] > 0))
            throw std::runtime_error("expected a sum from 0 and a count above 0, found " + mean.dump());
        means[name] = {mean[0], mean[1]};
    }
    return means;
}

std::vector<tactnet::epoch_report> curve_in(const json& points) {
    std::vector<tactnet::epoch_report> curve;
    for (const json& point : points) {
        if (point.size() != 4)
            throw std::runtime_error("expected 4 numbers of an epoch, found " + point.dump());
        tactnet::epoch_report& e = curve.emplace_back();
        e.epoch = count_in(point.at(0));
        e.loss = number_in(point.at(1));
        e.validation_loss = number_in(point.at(2));
        e.validation_accuracy = number_in(point.at(3));
    }
    return curve;
}

training_result result_of(const std::string& text) {
    const json line = json::parse(text);
    training_result r;
    r.settings = line.at("settings").get<tactnet::file_metadata>();
    r.validation_accuracy = number_in(line.at("validation_accuracy"));
    r.training_accuracy = number_in(line.at("training_accuracy"));
    r.reflected_accuracy = number_in(line.at("reflected_accuracy"));
    r.epochs = count_in(line.at("epochs"));
    r.seconds = line.at("seconds");
    const std::size_t classes = count_in(line.at("classes"));
    std::vector<std::size_t> counts;
    for (const json& count : line.at("confusion"))
        counts.push_back(count_in(count));
    if (classes > 100'000 || counts.size() != classes * classes ||
        std::accumulate(counts.begin(), counts.end(), 0.0) > 1e8)
        throw std::runtime_error("the confusion matrix does not have classes x classes counts");
    r.confusion = tactnet::confusion_matrix(classes);
    for (std::size_t i = 0; i < counts.size(); ++i)
        for (std::size_t n = 0; n < counts[i]; ++n)
            r.confusion.add(i / classes, i % classes);
    if (line.contains("calibration"))
        r.calibration = calibration_in(line["calibration"]);
    if (line.contains("decisions"))
        r.decisions = decisions_in(line["decisions"]);
    if (line.contains("curve"))
        r.curve = curve_in(line["curve"]);
    return r;
}

tactnet::file_metadata without_program(tactnet::file_metadata settings) {
    settings.erase("library");
    settings.erase("instruction_set");
    return settings;
}

} // namespace

std::vector<tactnet::epoch_report> curve_of(std::span<const tactnet::epoch_report> history) {
    constexpr std::size_t most = 60;
    std::size_t step = 1;
    for (std::size_t scale = 1; history.size() > most * step; scale *= 10)
        for (const std::size_t factor : {1U, 2U, 5U})
            if (history.size() > most * step)
                step = factor * scale;
    std::vector<tactnet::epoch_report> curve;
    for (const tactnet::epoch_report& e : history)
        if (e.epoch % step == 0)
            curve.push_back(e);
    return curve;
}

tactnet::file_metadata in_single_precision(tactnet::file_metadata settings) {
    settings.erase("bits");
    return settings;
}

result_list::result_list(std::filesystem::path path) : file_(std::move(path)) {
    read_on();
}

void result_list::read_on() {
    file_.read_on("a result of tactnet evaluate", [&](const std::string& line) {
        keep(result_of(line)); // including those of this program
    });
}

const training_result* result_list::find(const tactnet::file_metadata& settings) const {
    const auto found = results_.find(settings);
    return found == results_.end() ? nullptr : &found->second;
}

const training_result* result_list::find_elsewhere(const tactnet::file_metadata& settings) const {
    const auto found = elsewhere_.find(without_program(settings));
    return found == elsewhere_.end() ? nullptr : find(found->second);
}

void result_list::add(training_result result) {
    file_.add(line_of(result));
    keep(std::move(result));
}

void result_list::keep(training_result result) {
    tactnet::file_metadata settings = result.settings;
    if (settings.contains("library") && settings.contains("instruction_set"))
        elsewhere_.insert_or_assign(without_program(settings), settings);
    results_.try_emplace(std::move(settings), std::move(result));
}

std::optional<tactnet::temperature_scaling> fit_temperature(const tactnet::evaluation& held_out,
                                                            std::span<const std::size_t> images,
                                                            const image_data& data) {
    if (held_out.logits.empty() || !std::isfinite(held_out.loss))
        return std::nullopt;
    std::vector<std::size_t> labels;
    for (const std::size_t image : images)
        labels.push_back(data.images.labels[image]);
    const std::size_t classes = data.images.classes.size();
    return tactnet::fit_temperature(held_out.logits, classes, labels, classes);
}

calibration calibration_of(const tactnet::evaluation& result, std::span<const std::size_t> images,
                           const image_data& data, const tactnet::temperature_scaling& scaling) {
    calibration found{scaling};
    const std::size_t classes = data.images.classes.size();
    for (std::size_t i = 0; i * classes < result.logits.size(); ++i) {
        const auto logits = std::span(result.logits).subspan(i * classes, classes);
        const auto add = [&](const tactnet::temperature_scaling& by, tactnet::reliability_diagram& to) {
            if (const auto recognised = by.classify(logits, classes))
                to.add(recognised->probability, recognised->index == data.images.labels[images[i]]);
        };
        add({}, found.before);
        add(scaling, found.after);
    }
    return found;
}
