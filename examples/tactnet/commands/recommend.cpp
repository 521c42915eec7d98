// tactnet recommend: the best network of a study within a budget.

#include "commands/commands.hpp"
#include "console.hpp"
#include "files/line_file.hpp"
#include "number_options.hpp"
#include "reports/report.hpp"

#include <tactnet/io/file_error.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

struct recommend_options {
    std::string results = "study", split = "random";
    std::optional<double> microseconds;
    std::optional<std::size_t> bytes, rows, columns;
};

/// What a study found of a network.
struct studied_network {
    std::string method, recipe, declaration;
    std::size_t rows, columns, bits, splits, bytes;
    double accuracy, deviation, microseconds, p99;
};

/// Nothing for what is no network, or was not trained on such splits or timed.
std::optional<studied_network> network_of(const nlohmann::json& line, const std::string& split) {
    const auto& accuracy = line.at(split + "_accuracy");
    if (line.at("declaration") == "" || accuracy.is_null() || line.at("microseconds").is_null())
        return std::nullopt;
    return studied_network{line.at("method"),
                           line.at("recipe"),
                           line.at("declaration"),
                           line.at("rows"),
                           line.at("columns"),
                           line.at("bits"),
                           line.at(split + "_splits"),
                           line.at("bytes"),
                           accuracy,
                           line.at(split + "_deviation"),
                           line.at("microseconds"),
                           line.at("microseconds_p99")};
}

std::vector<studied_network> networks_in(const std::filesystem::path& path, const std::string& split) {
    std::vector<studied_network> found;
    std::size_t read = 0, all = 0;
    line_file(path).read_on("a row of tactnet study", [&](const std::string& text) {
        const auto line = nlohmann::json::parse(text);
        const std::size_t place = line.at("line");
        all = line.at("lines");
        if (place != read + 1)
            throw std::runtime_error(fmt::format("the row that was line {} of {}", place, all));
        ++read;
        if (auto network = network_of(line, split))
            found.push_back(std::move(*network));
    });
    if (read < all)
        throw tactnet::file_error(path.string(), fmt::format("line {}", read + 1),
                                  fmt::format("{} rows of tactnet study", all),
                                  fmt::format("the end behind {}", read));
    return found;
}

bool fits(const studied_network& n, const recommend_options& o) {
    return (!o.microseconds || n.microseconds <= *o.microseconds) && (!o.bytes || n.bytes <= *o.bytes) &&
           (!o.rows || n.rows <= *o.rows) && (!o.columns || n.columns <= *o.columns);
}

int recommend(const recommend_options& o) {
    const std::filesystem::path path = std::filesystem::path(o.results) / "study.jsonl";
    std::vector<studied_network> all = networks_in(path, o.split);
    if (all.empty())
        throw tactnet::file_error(path.string(), "",
                                  fmt::format("networks that were timed, and tested on {} splits", o.split),
                                  "none");
    const auto fastest = *std::ranges::min_element(all, {}, &studied_network::microseconds);
    std::erase_if(all, [&](const studied_network& n) { return !fits(n, o); });
    if (all.empty())
        refuse("expected a budget that a network of {} keeps, found none; the fastest, {} {}x{}{}, takes "
               "{:.2f} µs and {} bytes",
               path.string(), fastest.method, fastest.rows, fastest.columns,
               fastest.bits == 8 ? " in 8 bits" : "", fastest.microseconds, fastest.bytes);
    // A mean over few splits cannot be compared with one over many.
    const std::size_t most = std::ranges::max_element(all, {}, &studied_network::splits)->splits;
    std::erase_if(all, [&](const studied_network& n) { return n.splits < most; });
    std::ranges::stable_sort(all, [](const auto& a, const auto& b) {
        return a.accuracy != b.accuracy ? a.accuracy > b.accuracy : a.microseconds < b.microseconds;
    });
    const studied_network& best = all.front();
    print(fmt::format(
        "{} {}x{}{}, {} recipe: {:.2f} ± {:.2f} % over {} {} splits, {:.2f} µs per frame (p99 {:.2f}), "
        "{} bytes of weights\n{}\n",
        best.method, best.rows, best.columns, best.bits == 8 ? " in 8 bits" : "", best.recipe,
        100 * best.accuracy, 100 * best.deviation, best.splits, o.split, best.microseconds, best.p99,
        grouped(best.bytes), best.declaration));
    return success;
}

} // namespace

command add_recommend(CLI::App& program) {
    auto* app = program.add_subcommand(
        "recommend", "Print the most accurate network of a study within a budget, and its C++ type");
    auto o = std::make_shared<recommend_options>();
    app->add_option("--results", o->results, "Folder of a study");
    app->add_option("--microseconds", o->microseconds, "Maximum time per frame")->check(positive_number());
    app->add_option("--bytes", o->bytes, "Maximum size of the weights")
        ->check(whole_number(1, 1'000'000'000'000));
    app->add_option("--rows", o->rows, "Rows of the sensor, or fewer after resizing")
        ->check(whole_number(1, 100'000));
    app->add_option("--columns", o->columns, "Columns of the sensor, or fewer after resizing")
        ->check(whole_number(1, 100'000));
    app->add_option("--split", o->split, "Splits to compare by: 'random' or 'blocked'")
        ->check(CLI::IsMember({"random", "blocked"}));
    return [o] { return recommend(*o); };
}
