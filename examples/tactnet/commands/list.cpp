// tactnet list: the methods that were compiled in, and what they cost.

#include "commands/commands.hpp"
#include "methods/registry.hpp"

namespace {

/// The largest number of classes of a network.
std::size_t most_classes() {
    std::size_t most = 2;
    for (const auto& m : all_methods())
        if (m->is_network())
            most = std::max(most, m->capacity);
    return most;
}

int list(std::optional<std::size_t> classes) {
    std::vector<std::vector<std::string>> rows{{"method", "size", "classes", "parameters", "multiply-adds",
                                                "on pixels", "weights, bytes", "activations, bytes"}};
    for (const auto& m : all_methods()) {
        const std::size_t k = classes.value_or(std::min(m->capacity, most_classes()));
        const method_costs c = m->costs(k);
        rows.push_back({m->name, m->size(), fmt::to_string(k), grouped(c.parameters),
                        grouped(c.multiply_adds), grouped(c.multiply_adds_on_pixels),
                        grouped(c.parameter_bytes), grouped(c.activation_bytes)});
    }
    print(table(rows));
    return success;
}

} // namespace

command add_list(CLI::App& program) {
    auto* app = program.add_subcommand("list", "List the methods that were compiled in, with their costs");
    auto classes = std::make_shared<std::optional<std::size_t>>();
    add_option(*app, "--classes", *classes, whole_number(2, most_classes()),
               "Number of classes, 2 or more (default: the maximum of this program)");
    return [classes] { return list(*classes); };
}
