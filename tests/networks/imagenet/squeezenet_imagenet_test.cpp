#include <tactnet/io/model_file.hpp>
#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/imagenet.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <networks/imagenet/stages.hpp>
#include <support/files/data_folder.hpp>
#include <vector>

using namespace tactnet;

TEST_CASE("squeezenet: the weights of ImageNet load by name, and give PyTorch's features of tactile images" *
          doctest::test_suite("data")) {
    const auto weights_file = support::find_data("squeezenet1_1_imagenet_features.safetensors");
    const auto images_file = support::find_data("published_tactnet4_14x25_golden.safetensors");
    if (!weights_file || !images_file)
        return;
    constexpr std::size_t side = 227;
    using trunk = squeezenet1_1_trunk<shape{side, side, 3}>;
    const safetensors weights = safetensors::read(*weights_file);
    trunk net;
    load_parameters(net, weights);
    const std::vector<float> mean = weights.values<float>("input_mean");

    // Each tactel repeated, as in imagenet_networks.py.
    const auto images = safetensors::read(*images_file).values<std::uint8_t>("inputs");
    constexpr std::array<std::size_t, 3> numbers{0, 37, 109};
    trunk::input_batch in(numbers.size());
    trunk::output_batch out(numbers.size());
    for (std::size_t i = 0; i < numbers.size(); ++i)
        for (std::size_t e = 0; e < trunk::input_shape.size(); ++e) {
            const std::size_t row = e / side % side * 14 / side, column = e % side * 25 / side;
            in(i, e) =
                static_cast<float>(images[numbers[i] * 350 + row * 25 + column]) - mean[e / (side * side)];
        }
    thread_pool threads;
    trunk::workspace space;
    net.prepare(threads, space);
    net.logits(in, out, threads, space);
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        support::golden_stages golden(std::to_string(numbers[i]), "squeezenet_imagenet");
        golden.compare("features.12", trunk::outputs, [&](std::size_t e) { return out(i, e); });
        CHECK(golden.compared == 1);
        MESSAGE("image " << numbers[i] << ": largest error ÷ its deviation " << golden.worst);
    }
}
