// Trains a network that holds a layer of your own, saves it, loads it again, deploys it and writes it as a
// header:
//
//   tactnet_own_layer WEIGHTS.safetensors HEADER.hpp
//
// The images are drawn here: bars that lie, bars that stand, and crosses.

#include "network.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/training.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <span>
#include <stdexcept>
#include <vector>

namespace {

constexpr std::size_t rows = own::network::input_shape.rows, columns = own::network::input_shape.columns;
constexpr std::size_t images_of_each = 40;

/// Image after image, class after class.
std::vector<std::uint8_t> draw_images() {
    std::vector<std::uint8_t> pixels;
    for (std::size_t label = 0; label < 3; ++label)
        for (std::size_t i = 0; i < images_of_each; ++i)
            for (std::size_t row = 0; row < rows; ++row)
                for (std::size_t column = 0; column < columns; ++column) {
                    const bool lies = row == 1 + i % 5, stands = column == 1 + i % 11;
                    const bool pressed = (label != 1 && lies) || (label != 0 && stands);
                    pixels.push_back(static_cast<std::uint8_t>(pressed ? 100 + i * 3 : 0));
                }
    return pixels;
}

void run(const char* weights, const char* header) {
    const std::vector<std::uint8_t> pixels = draw_images();
    std::vector<std::size_t> labels;
    for (std::size_t i = 0; i < 3 * images_of_each; ++i)
        labels.push_back(i / images_of_each);
    const tactnet::labelled_images images{pixels, labels, 3};

    tactnet::recipe how = tactnet::recipe::default_for(rows, columns);
    how.epochs = 12;
    how.augmentation = tactnet::augmentation_rule::none; // a turned bar that lies is a bar that stands
    const tactnet::data_split split = tactnet::split_data(labels, 3, tactnet::split_rule::random, 1);
    tactnet::thread_pool threads;
    tactnet::trainer<own::network> trainer(how, images, split, 1, threads);
    while (!trainer.finished())
        trainer.run_epoch();
    tactnet::save_model(weights, trainer.trained({"lies", "stands", "cross"}));

    const auto model = tactnet::load_model<own::network>(weights);
    const auto network = tactnet::deploy(model);
    std::size_t right = 0;
    constexpr std::size_t size = rows * columns;
    for (const std::size_t i : split.test) {
        const auto found = network.classify(
            tactnet::tensor_view<const std::uint8_t, own::network::input_shape>(pixels.data() + i * size));
        right += found && found->index == labels[i];
    }
    std::printf("%zu of %zu test images recognised\n", right, split.test.size());
    if (2 * right < split.test.size())
        throw std::runtime_error("expected at least half of the test images to be recognised");

    tactnet::write_file(header,
                        tactnet::deployed_header(
                            network, {.network = "own", .namespace_name = "bars", .classes = model.classes},
                            std::span(pixels).template first<size>()));
}

} // namespace

int main(int count, char** arguments) {
    if (count != 3) {
        std::fprintf(stderr, "own_layer: expected a weight file and a header to write\n");
        return 2;
    }
    try {
        run(arguments[1], arguments[2]);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "own_layer: %s\n", error.what());
        return 2;
    }
    return 0;
}
