// tactnet export: a weight file becomes a C++ header, for targets without files.

#include "commands/commands.hpp"
#include "files/places.hpp"
#include "methods/weights.hpp"
#include "reports/report.hpp"
#include "usage_error.hpp"

#include <tactnet/io/file.hpp>
#include <tactnet/io/text.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

struct export_options {
    weight_options weights;
    std::string output, namespace_name = "tactile", packing;
};

/// The first frame of the file's self-test, or a bright bar.
std::vector<std::uint8_t> selftest_frame(const std::string& path, const method& what) {
    const std::size_t size = what.rows * what.columns;
    const tactnet::safetensors file = tactnet::safetensors::read(path);
    std::vector<std::uint8_t> frame;
    if (file.contains("selftest.input")) // of the right size, or the network would not have been loaded
        frame = file.values<std::uint8_t>("selftest.input");
    frame.resize(size);
    if (!file.contains("selftest.input"))
        for (std::size_t i = 0; i < size; ++i)
            frame[i] = i % what.columns / 3 == 1 ? 150 : 0;
    return frame;
}

int export_header(const export_options& o) {
    if (!tactnet::is_namespace_name(o.namespace_name))
        throw usage_error(fmt::format("--namespace: expected a name such as gripper or gripper::tactile, "
                                      "found {}",
                                      tactnet::in_quotes(o.namespace_name)));
    const std::vector<named_file> outputs{{"--output", o.output}};
    check_places({{"--weights", o.weights.weights}, {"--classes", o.weights.classes}}, outputs);
    tidy_folders_of(outputs);
    const loaded_weights weights = load_weights(o.weights);
    const auto* network = dynamic_cast<const trained_network*>(weights.trained.get());
    if (network == nullptr)
        throw usage_error(fmt::format("{}: expected a network, found the {} {}, which cannot be written as a "
                                      "header",
                                      o.weights.weights, weights.what->kind(), weights.what->name));
    tactnet::header_description says{
        .network = weights.what->name, .namespace_name = o.namespace_name, .classes = weights.classes};
    if (!o.packing.empty())
        says.when = o.packing == "at-start" ? tactnet::packing::at_start : tactnet::packing::when_compiling;
    std::string text;
    try {
        text = network->header(says, selftest_frame(o.weights.weights, *weights.what));
    } catch (const std::invalid_argument& error) { // variances below zero, numbers without end
        throw usage_error(fmt::format("{}: {}", o.weights.weights, error.what()));
    }
    make_folder_of(o.output);
    tactnet::write_file(o.output, text);
    return success;
}

} // namespace

command add_export(CLI::App& program) {
    auto* app = program.add_subcommand(
        "export", "Write a trained network as a C++ header, for programs without files, heap and exceptions");
    auto o = std::make_shared<export_options>();
    add_weight_options(*app, o->weights);
    app->add_option("--output", o->output, "Header to write")->type_name("FILE")->required();
    app->add_option("--namespace", o->namespace_name, "Namespace of everything in it (default: tactile)")
        ->type_name("NAME");
    app->add_option(
           "--packing", o->packing,
           "When weights are brought into the order of use (default: when-compiling if there are few "
           "enough for the usual limits of compilers)")
        ->type_name("WHEN")
        ->check(CLI::IsMember({"when-compiling", "at-start"}));
    return [o] { return export_header(*o); };
}
