// tactnet recommend: the best network of a study within a budget.

#include "commands/commands.hpp"
#include "files/line_file.hpp"

#include <tuple>

namespace {

struct recommend_options {
    std::string results = "study", split = "random";
    std::optional<double> microseconds;
    std::optional<std::size_t> bytes, rows, columns;
};

/// The rows of networks that were timed, and tested on such splits.
std::vector<nlohmann::json> networks_in(const std::filesystem::path& path, const std::string& split) {
    std::vector<nlohmann::json> found;
    std::size_t read = 0, all = 0;
    line_file(path).read_on("a row of tactnet study", [&](const std::string& text) {
        nlohmann::json line = nlohmann::json::parse(text);
        const std::size_t place = line.at("line");
        all = line.at("lines");
        if (place != read + 1)
            throw std::runtime_error(fmt::format("the row that was line {} of {}", place, all));
        ++read;
        if (line.at("declaration") != "" && !line.at(split + "_accuracy").is_null() &&
            !line.at("microseconds").is_null())
            found.push_back(std::move(line));
    });
    if (read < all)
        refuse("{}: line {}: expected {} rows of tactnet study, found the end behind {}", path.string(),
               read + 1, all, read);
    return found;
}

/// "tactnet6 28x50 in 8 bits".
std::string title_of_network(const nlohmann::json& row) {
    return fmt::format("{} {}x{}{}", row.at("method").get<std::string>(), row.at("rows").get<int>(),
                       row.at("columns").get<int>(), row.at("bits") == 8 ? " in 8 bits" : "");
}

int recommend(const recommend_options& o) {
    const std::filesystem::path path = std::filesystem::path(o.results) / "study.jsonl";
    std::vector<nlohmann::json> all = networks_in(path, o.split);
    if (all.empty())
        refuse("{}: expected networks that were timed, and tested on {} splits, found none", path.string(),
               o.split);
    const auto by = [](const std::string& member) {
        return [member](const nlohmann::json& row) { return row.at(member).get<double>(); };
    };
    const auto time = by("microseconds"), accuracy = by(o.split + "_accuracy"),
               splits = by(o.split + "_splits");
    const nlohmann::json fastest = *std::ranges::min_element(all, {}, time);
    std::erase_if(all, [&](const nlohmann::json& row) {
        return (o.microseconds && time(row) > *o.microseconds) || (o.bytes && row.at("bytes") > *o.bytes) ||
               (o.rows && row.at("rows") > *o.rows) || (o.columns && row.at("columns") > *o.columns);
    });
    if (all.empty())
        refuse(
            "expected a budget that a network of {} keeps, found none; the fastest, {}, takes {:.2f} µs and "
            "{} bytes",
            path.string(), title_of_network(fastest), time(fastest), fastest.at("bytes").get<std::size_t>());
    // A mean over few splits cannot be compared with one over many.
    const nlohmann::json& best = *std::ranges::max_element(all, {}, [&](const nlohmann::json& row) {
        return std::tuple(splits(row), accuracy(row), -time(row));
    });
    print(fmt::format("{}, {} recipe: {:.2f} ± {:.2f} % over {} {} splits, {:.2f} µs per frame (p99 {:.2f}), "
                      "{} bytes of weights\n{}\n",
                      title_of_network(best), best.at("recipe").get<std::string>(), 100 * accuracy(best),
                      100 * by(o.split + "_deviation")(best), splits(best), o.split, time(best),
                      by("microseconds_p99")(best), grouped(best.at("bytes")),
                      best.at("declaration").get<std::string>()));
    return success;
}

} // namespace

command add_recommend(CLI::App& program) {
    auto* app = program.add_subcommand(
        "recommend", "Print the most accurate network of a study within a budget, and its C++ type");
    auto o = std::make_shared<recommend_options>();
    app->add_option("--results", o->results, "Folder of a study");
    add_option(*app, "--microseconds", o->microseconds, positive_number(), "Maximum time per frame");
    add_option(*app, "--bytes", o->bytes, whole_number(1, 1'000'000'000'000), "Maximum size of the weights");
    add_option(*app, "--rows", o->rows, whole_number(1, 100'000),
               "Rows of the sensor, or fewer after resizing");
    add_option(*app, "--columns", o->columns, whole_number(1, 100'000),
               "Columns of the sensor, or fewer after resizing");
    add_option(*app, "--split", o->split, CLI::IsMember({"random", "blocked"}),
               "Splits to compare by: 'random' or 'blocked'");
    return [o] { return recommend(*o); };
}
