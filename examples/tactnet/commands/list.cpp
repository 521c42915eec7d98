// tactnet list: the networks that were compiled in, those behind others, and what they cost.

#include "commands/commands.hpp"
#include "console/standard_streams.hpp"
#include "methods/registry.hpp"
#include "number_options.hpp"
#include "reports/report.hpp"
#include "usage_error.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <memory>

command add_list(CLI::App& program) {
    auto* app = program.add_subcommand(
        "list",
        "Show the networks that were compiled in, methods behind pretrained networks, and what they cost");
    auto classes = std::make_shared<std::size_t>(0);
    app->add_option("--classes", *classes, "Classes to tell apart (default: as many as the program can)")
        ->type_name("N")
        ->check(whole_number(2, 100'000));
    return [classes] {
        std::vector<std::vector<std::string>> rows{{"method", "size", "classes", "parameters",
                                                    "multiply-adds", "on pixels", "weights, bytes",
                                                    "activations, bytes"}};
        std::size_t most = 2; // that a network can tell apart
        for (const auto& m : all_methods())
            if (m->is_network())
                most = std::max(most, m->capacity);
        for (const auto& m : all_methods()) {
            if (!m->is_network() && !m->pretrained()) // it costs what it learnt, no more
                continue;
            const std::size_t k = *classes > 0 ? *classes : std::min(m->capacity, most);
            if (k > m->capacity)
                throw usage_error(fmt::format("--classes: expected at most {}, found {}", m->capacity, k));
            const method_costs c = m->costs(k);
            rows.push_back({m->name, fmt::format("{}x{}", m->rows, m->columns), fmt::to_string(k),
                            grouped(c.parameters), grouped(c.multiply_adds),
                            grouped(c.multiply_adds_on_pixels), grouped(c.parameter_bytes),
                            grouped(c.activation_bytes)});
        }
        print(table(rows));
        return int{success};
    };
}
