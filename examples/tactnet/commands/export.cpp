// tactnet export: a weight file becomes a C++ header, with --bits 8 one in 8 bits or another weight file, or
// with --onnx a model for other runtimes.

#include "commands/commands.hpp"
#include "files/output_files.hpp"
#include "methods/weights.hpp"

#include <tactnet/io/write_file.hpp>
#include <tactnet/svm/feature_rows.hpp>

namespace {

struct export_options {
    weight_options weights;
    std::string output, namespace_name = "tactile", packing, data, images = "training";
    group_options groups;
    std::size_t bits = 32;
    bool onnx = false;
};

/// The frames of the file's self-test, or a made-up one.
std::vector<std::uint8_t> selftest_frames(const std::string& path, const method& what) {
    const tactnet::safetensors file = tactnet::safetensors::read(path);
    if (file.contains("selftest.input")) // of the right size, or the network would not have been loaded
        return file.values<std::uint8_t>("selftest.input");
    return made_up_touches(1, {what.rows, what.columns});
}

/// Whether the output is a weight file; else it is a header.
bool is_weight_file(const export_options& o) {
    return o.output.ends_with(".safetensors");
}

/// Throws usage_error for options that do not go together.
void check(const export_options& o) {
    if (!tactnet::is_namespace_name(o.namespace_name))
        refuse("--namespace: expected a name such as gripper or gripper::tactile, found {}",
               tactnet::in_quotes(o.namespace_name));
    if (o.bits == 8 && o.data.empty())
        refuse(
            "--bits: expected --data with the images of the training, which tell what numbers a network in "
            "8 bits must hold, found none");
    if (o.bits != 8 && !o.data.empty())
        refuse("--data: expected --bits 8, for which images are, found single precision");
    if (is_weight_file(o) && !o.weights.classes.empty())
        refuse("--classes: expected a header to write, found a weight file, which keeps the names of the "
               "other");
    if (o.onnx && (o.bits == 8 || !o.packing.empty() || is_weight_file(o)))
        refuse("--onnx: expected an ONNX file to write, in single precision, found --bits 8, --packing or "
               "the name of a weight file");
    if (o.bits != 8 && is_weight_file(o))
        refuse("--output: expected --bits 8, with which a weight file becomes another, or the name of a "
               "header, found a name that ends in .safetensors");
}

/// The network of the file in 8 bits.
std::unique_ptr<trained_network> turned_to_bytes(const export_options& o, const loaded_weights& weights) {
    if (weights.trained->bits() == 8)
        refuse("{}: metadata 'bits': expected weights in single precision, of which --bits 8 makes bytes, "
               "found '8'",
               o.weights.weights);
    check_bits(*weights.what, o.bits);
    const image_data data =
        load_data(o.data, weights.what->rows, weights.what->columns, o.weights.images, o.groups);
    return in_eight_bits(*weights.trained, data.view(),
                         o.images == "all"
                             ? tactnet::all_samples(data.images.size())
                             : stored_split(o.weights.weights, weights.metadata, o.data, data).training);
}

int export_network(const export_options& o) {
    check(o);
    check_outputs({{"--weights", o.weights.weights}, {"--classes", o.weights.classes}},
                  {{"--output", o.output}}, o.data);
    const loaded_weights weights = load_weights(o.weights);
    const auto* network = dynamic_cast<const trained_network*>(weights.trained.get());
    if (network == nullptr)
        refuse("{}: expected a network, found the {} {}, which cannot be written as a header",
               o.weights.weights, weights.what->kind(), weights.what->name);
    if (o.onnx) {
        const std::string model = network->onnx();
        if (model.empty())
            refuse("{}: expected a network in single precision whose layers ONNX has, found {}",
                   o.weights.weights, weights.trained->bits() == 8 ? "one in 8 bits" : "others");
        make_folder_of(o.output);
        tactnet::write_file(o.output, model);
        return success;
    }
    const std::vector<std::uint8_t> frames = selftest_frames(o.weights.weights, *weights.what);
    std::unique_ptr<trained_network> in_bytes;
    if (o.bits == 8) {
        in_bytes = turned_to_bytes(o, weights);
        network = in_bytes.get();
        tell("in 8 bits {}\n", in_bytes->calibration());
    }
    if (is_weight_file(o)) {
        tactnet::file_metadata metadata = weights.metadata;
        metadata["network"] = weights.what->name;
        for (const char* key : {"epsilon", "input_scale", "test_accuracy", "validation_accuracy"})
            metadata.erase(key); // which are of single precision
        make_folder_of(o.output);
        network->save(o.output, metadata, frames);
        return success;
    }
    tactnet::header_description says{
        .network = weights.what->name, .namespace_name = o.namespace_name, .classes = weights.classes};
    if (!o.packing.empty())
        says.when = o.packing == "at-start" ? tactnet::header_packing::at_start
                                            : tactnet::header_packing::when_compiling;
    std::string text;
    try {
        text = network->header(says, std::span(frames).first(weights.what->rows * weights.what->columns));
    } catch (const std::invalid_argument& error) { // variances below zero, numbers without end
        refuse("{}: {}", o.weights.weights, error.what());
    }
    make_folder_of(o.output);
    tactnet::write_file(o.output, text);
    return success;
}

} // namespace

command add_export(CLI::App& program) {
    auto* app = program.add_subcommand(
        "export",
        "Write a trained network as a C++ header, for programs without files, heap and exceptions; or "
        "in 8 bits, as a header or a weight file; or as an ONNX file");
    auto o = std::make_shared<export_options>();
    add_weight_options(*app, o->weights);
    app->add_option("--output", o->output,
                    "Header to write; with --bits 8 a weight file, if its name ends in .safetensors")
        ->type_name("FILE")
        ->required();
    add_bits_option(*app, o->bits,
                    "8: turn weights in single precision into 8 bits; a file in 8 bits needs no such option");
    app->add_option("--data", o->data, "With --bits 8: the folder of images that the network was trained on");
    add_group_options(*app, o->groups);
    add_option(*app, "--images", o->images, CLI::IsMember({"training", "all"}),
               "Use the 'training' images of its split, or 'all' images; never use test images");
    app->add_flag("--onnx", o->onnx, "Write an ONNX file, for other runtimes: counts in, logits out");
    app->add_option("--namespace", o->namespace_name, "Namespace of the header");
    add_option(*app, "--packing", o->packing, CLI::IsMember({"when-compiling", "at-start"}),
               "When weights are packed (default: when-compiling if that stays within the usual limits of "
               "compilers)");
    return [o] { return export_network(*o); };
}
