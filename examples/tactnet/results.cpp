#include "results.hpp"

#include "report.hpp"

#include <tactnet/io/file.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace {

using nlohmann::json;

std::string line_of(const training_result& r) {
    std::vector<std::size_t> counts;
    for (std::size_t truth = 0; truth < r.confusion.classes(); ++truth)
        for (std::size_t c = 0; c < r.confusion.classes(); ++c)
            counts.push_back(r.confusion(truth, c));
    nlohmann::ordered_json line;
    line["settings"] = r.settings;
    line["accuracy"] = r.confusion.accuracy();
    line["validation_accuracy"] = std::isfinite(r.validation_accuracy)
                                      ? nlohmann::ordered_json(r.validation_accuracy)
                                      : nlohmann::ordered_json(nullptr);
    line["epochs"] = r.epochs;
    line["seconds"] = r.seconds;
    line["images_per_second"] = r.images_per_second;
    line["classes"] = r.confusion.classes();
    line["confusion"] = counts;
    return line.dump() + '\n';
}

training_result result_of(const std::string& text) {
    const json line = json::parse(text);
    training_result r;
    r.settings = line.at("settings").get<tactnet::file_metadata>();
    const json& validation = line.at("validation_accuracy");
    r.validation_accuracy = validation.is_null() ? std::nan("") : validation.get<double>();
    r.epochs = line.at("epochs");
    r.seconds = line.at("seconds");
    r.images_per_second = line.at("images_per_second");
    const std::size_t classes = line.at("classes");
    const auto counts = line.at("confusion").get<std::vector<std::size_t>>();
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

result_list::result_list(std::filesystem::path path) : path_(std::move(path)) {
    std::error_code code;
    if (!std::filesystem::exists(path_, code))
        return;
    const auto bytes = tactnet::read_file(path_);
    std::string_view rest(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    for (std::size_t number = 1, end = 0; (end = rest.find('\n')) != std::string_view::npos; ++number) {
        try {
            results_.push_back(result_of(std::string(rest.substr(0, end))));
        } catch (const std::exception& error) {
            throw tactnet::file_error(path_.string(), fmt::format("line {}", number),
                                      "a result of tactnet evaluate", fmt::format("'{}'", error.what()));
        }
        rest.remove_prefix(end + 1);
        good_bytes_ += end + 1;
    }
}

const training_result* result_list::find(const tactnet::file_metadata& settings) const {
    for (const training_result& r : results_)
        if (r.settings == settings)
            return &r;
    return nullptr;
}

void result_list::add(training_result result) {
    const std::string line = line_of(result);
    make_folder_of(path_);
    std::error_code code;
    if (const auto size = std::filesystem::file_size(path_, code); !code && size > good_bytes_)
        std::filesystem::resize_file(path_, good_bytes_, code);
    const auto file = tactnet::detail::open_file(path_, "ab");
    const std::span<const std::byte> piece = std::as_bytes(std::span(line.data(), line.size()));
    const int error = file ? tactnet::detail::write_and_flush(file.get(), std::span(&piece, 1)) : errno;
    if (error != 0)
        throw tactnet::file_error(path_.string(), "", "to add a line",
                                  fmt::format("'{}'", std::generic_category().message(error)));
    good_bytes_ += line.size();
    results_.push_back(std::move(result));
}
