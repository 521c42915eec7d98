// tactnet classify: images in, a line each out.

#include "commands/commands.hpp"
#include "methods/weights.hpp"

namespace {

struct classify_options {
    weight_options weights;
    std::vector<std::string> images;
};

int classify(const classify_options& o) {
    const loaded_weights weights = load_weights(o.weights);
    const std::size_t rows = weights.what->rows, columns = weights.what->columns;
    const std::optional<double> full_scale = o.weights.images.full_scale();
    // All images are looked at before anything is said, so that a bad one does not leave half a list.
    std::vector<std::uint8_t> pixels;
    for (const std::string& path : o.images) {
        const tactnet::grey_image image = load_image(path, rows, columns, o.weights.images, full_scale);
        pixels.insert(pixels.end(), image.pixels.begin(), image.pixels.end());
    }
    // A line an image, whatever its path; names of classes are printable, or their file is not loaded.
    const auto field = [](const std::string& name) { return csv_field(printable(name)); };
    tactnet::thread_pool threads;
    const std::vector<scored_class> recognised = weights.trained->recognise(pixels, threads);
    for (std::size_t i = 0; i < o.images.size(); ++i) {
        const auto& [label, score] = recognised[i];
        print(fmt::format("{},{},{},{:.6f}\n", field(o.images[i]), label, field(weights.classes[label]),
                          score));
    }
    return success;
}

} // namespace

command add_classify(CLI::App& program) {
    auto* app = program.add_subcommand(
        "classify", "Recognise images: prints path,class_index,class_name,probability "
                    "per image (for a support vector machine "
                    "without probabilities, its decision value; see docs/recognise/program.md)");
    auto o = std::make_shared<classify_options>();
    add_weight_options(*app, o->weights);
    app->add_option("IMAGE", o->images, "Grey JPEG, PNG or NPY images")->required();
    return [o] { return classify(*o); };
}
