#include "evaluation/table.hpp"

#include "methods/training_settings.hpp"
#include "reports/report.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <utility>

namespace {

std::string percent(const tactnet::mean_and_deviation& m) {
    return fmt::format("{:.2f} ± {:.2f}", 100 * m.mean, 100 * m.deviation);
}

bool tells_bits(const std::vector<evaluation_row>& rows) {
    return std::ranges::any_of(rows, [](const evaluation_row& s) { return s.bits == 8; });
}

nlohmann::ordered_json json_of(const evaluation_row& s, bool with_bits) {
    nlohmann::ordered_json object{{"network", s.what->name},
                                  {"rows", s.what->rows},
                                  {"columns", s.what->columns},
                                  {"recipe", s.recipe},
                                  {"splits", s.splits}};
    if (with_bits)
        object["bits"] = s.bits;
    for (const auto& [rule, accuracy] : s.accuracies) {
        object[fmt::format("{}_accuracy", name_of(rule))] = accuracy.mean;
        object[fmt::format("{}_deviation", name_of(rule))] = accuracy.deviation;
    }
    object["parameters"] = s.costs.parameters;
    object["multiply_adds"] = s.costs.multiply_adds;
    object["multiply_adds_on_pixels"] = s.costs.multiply_adds_on_pixels;
    object["bytes"] = s.costs.parameter_bytes;
    object["activation_bytes"] = s.costs.activation_bytes;
    object["microseconds"] = s.times.alone;
    object["microseconds_in_batch"] = s.times.in_batch;
    object["training_seconds"] = s.seconds.mean;
    return object;
}

} // namespace

std::string table_of(const std::vector<evaluation_row>& rows) {
    const bool with_bits = tells_bits(rows);
    std::vector<std::vector<std::string>> cells;
    for (const evaluation_row& s : rows) {
        std::vector<std::string> head{"method", "size"},
            line{s.what->name, fmt::format("{}x{}", s.what->rows, s.what->columns)};
        if (with_bits) {
            head.push_back("bits");
            line.push_back(fmt::to_string(s.bits));
        }
        for (const auto& [rule, accuracy] : s.accuracies) {
            head.push_back(fmt::format("{}, %", name_of(rule)));
            line.push_back(percent(accuracy));
        }
        head.insert(head.end(), {"parameters", "multiply-adds", "on pixels", "bytes", "µs/frame",
                                 "µs in batch", "training, s"});
        line.insert(line.end(),
                    {grouped(s.costs.parameters), grouped(s.costs.multiply_adds),
                     grouped(s.costs.multiply_adds_on_pixels), grouped(s.costs.parameter_bytes),
                     fmt::format("{:.1f}", s.times.alone), fmt::format("{:.1f}", s.times.in_batch),
                     fmt::format("{:.1f}", s.seconds.mean)});
        if (cells.empty())
            cells.push_back(std::move(head));
        cells.push_back(std::move(line));
    }
    return table(cells);
}

std::string json_lines_of(const std::vector<evaluation_row>& rows) {
    std::string lines;
    for (const evaluation_row& s : rows)
        lines += json_of(s, tells_bits(rows)).dump() + '\n';
    return lines;
}

std::string csv_of(const std::vector<evaluation_row>& rows) {
    std::vector<nlohmann::ordered_json> objects;
    for (const evaluation_row& s : rows)
        objects.push_back(json_of(s, tells_bits(rows)));
    return csv_of(objects);
}
