#include "evaluation/results.hpp"

#include <nlohmann/json.hpp>

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

std::string line_of(const training_result& r) {
    std::vector<std::size_t> counts;
    for (std::size_t truth = 0; truth < r.confusion.classes(); ++truth)
        for (std::size_t c = 0; c < r.confusion.classes(); ++c)
            counts.push_back(r.confusion(truth, c));
    nlohmann::ordered_json line;
    line["settings"] = r.settings;
    line["accuracy"] = r.confusion.accuracy();
    line["validation_accuracy"] = number_or_null(r.validation_accuracy);
    line["training_accuracy"] = number_or_null(r.training_accuracy);
    line["epochs"] = r.epochs;
    line["seconds"] = r.seconds;
    line["images_per_second"] = r.images_per_second;
    line["classes"] = r.confusion.classes();
    line["confusion"] = counts;
    return line.dump();
}

/// nlohmann::json turns any number into the type that is asked for.
std::size_t count_in(const json& value) {
    if (!value.is_number_unsigned())
        throw std::runtime_error("expected a whole number from 0, found " + value.dump());
    return value.get<std::size_t>();
}

training_result result_of(const std::string& text) {
    const json line = json::parse(text);
    training_result r;
    r.settings = line.at("settings").get<tactnet::file_metadata>();
    const auto number_in = [](const json& value) {
        return value.is_null() ? std::nan("") : value.get<double>();
    };
    r.validation_accuracy = number_in(line.at("validation_accuracy"));
    r.training_accuracy =
        line.contains("training_accuracy") ? number_in(line["training_accuracy"]) : std::nan("");
    r.epochs = count_in(line.at("epochs"));
    r.seconds = line.at("seconds");
    r.images_per_second = line.at("images_per_second");
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
    return r;
}

} // namespace

result_list::result_list(std::filesystem::path path) : file_(std::move(path)) {
    read_on();
}

std::filesystem::path result_list::claims_path() const {
    return file_.path().parent_path() / ".evaluation.lock";
}

void result_list::read_on() {
    file_.read_on("a result of tactnet evaluate", [&](const std::string& line) {
        keep(result_of(line)); // one's own come back
    });
}

const training_result* result_list::find(const tactnet::file_metadata& settings) const {
    const auto found = results_.find(settings);
    return found == results_.end() ? nullptr : &found->second;
}

void result_list::add(training_result result) {
    file_.add(line_of(result));
    keep(std::move(result));
}

void result_list::keep(training_result result) {
    tactnet::file_metadata settings = result.settings;
    results_.try_emplace(std::move(settings), std::move(result));
}
