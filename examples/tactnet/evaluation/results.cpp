#include "evaluation/results.hpp"

#include "methods/description.hpp"

#include <tactnet/decision/fitting.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <set>

namespace {

using nlohmann::json;

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
    line["validation_accuracy"] = r.validation_accuracy; // null for NaN
    line["training_accuracy"] = r.training_accuracy;
    line["reflected_accuracy"] = r.reflected_accuracy;
    line["epochs"] = r.epochs;
    line["seconds"] = r.seconds;
    line["classes"] = r.confusion.classes();
    line["confusion"] = counts;
    if (r.calibration)
        line["calibration"] = {{"temperature", r.calibration->scaling.temperature},
                               {"before", bins_of(r.calibration->before)},
                               {"after", bins_of(r.calibration->after)}};
    return line.dump();
}

double number_in(const json& value) {
    return value.is_null() ? std::nan("") : value.get<double>();
}

tactnet::reliability_diagram diagram_in(const json& list) {
    std::array<tactnet::reliability_diagram::bin, tactnet::reliability_diagram::bin_count> bins;
    for (std::size_t b = 0; b < bins.size(); ++b)
        bins[b] = {list.at(b).at(0), list[b].at(1), list[b].at(2), list[b].at(3)};
    return tactnet::reliability_diagram(bins);
}

/// As line_of wrote it: its checksum says that nothing has changed since.
training_result result_of(const std::string& text) {
    const json line = json::parse(text);
    training_result r;
    r.settings = line.at("settings").get<tactnet::file_metadata>();
    if (const auto found = r.settings.find("instruction_set"); found != r.settings.end())
        found->second = float_instruction_set(found->second); // before version 0.4, whole
    r.validation_accuracy = number_in(line.at("validation_accuracy"));
    r.training_accuracy = number_in(line.at("training_accuracy"));
    r.reflected_accuracy = number_in(line.at("reflected_accuracy"));
    r.epochs = line.at("epochs");
    r.seconds = line.at("seconds");
    const std::size_t classes = line.at("classes");
    r.confusion = tactnet::confusion_matrix(classes);
    for (std::size_t i = 0; i < classes * classes; ++i)
        for (std::size_t n = line.at("confusion").at(i); n > 0; --n)
            r.confusion.add(i / classes, i % classes);
    if (line.contains("calibration")) {
        const json& of = line["calibration"];
        r.calibration =
            calibration{{of.at("temperature")}, diagram_in(of.at("before")), diagram_in(of.at("after"))};
    }
    return r;
}

tactnet::file_metadata without_program(tactnet::file_metadata settings) {
    settings.erase("library");
    settings.erase("instruction_set");
    return settings;
}

} // namespace

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

std::string result_list::others(const std::vector<tactnet::file_metadata>& wanted) const {
    std::set<tactnet::file_metadata> known;
    for (const tactnet::file_metadata& settings : wanted)
        known.insert(without_program(in_single_precision(settings)));
    std::set<std::string> reasons;
    std::size_t count = 0;
    for (const auto& [settings, result] : results_) {
        const tactnet::file_metadata one = without_program(settings);
        if (settings.contains("bits") || known.contains(one))
            continue;
        if (++count > 50) // of a longer list, the first will do
            continue;
        // Compared with the nearest that is wanted.
        std::set<std::string> fewest;
        for (const tactnet::file_metadata& other : known) {
            std::set<std::string> differing;
            for (const auto& [a, b] : {std::pair(&one, &other), {&other, &one}})
                for (const auto& [key, value] : *a)
                    if (const auto same = b->find(key); same == b->end() || same->second != value)
                        differing.insert(key);
            if (fewest.empty() || differing.size() < fewest.size())
                fewest = differing;
        }
        reasons.merge(fewest);
    }
    return count == 0 ? "" : fmt::format("{} others lie there, of other {}", count, fmt::join(reasons, ", "));
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
