// What has drawn warnings from GCC in each room, inlined into a user's own functions.

#include <tactnet/io.hpp>
#include <tactnet/simulation.hpp>
#include <tactnet/svm.hpp>
#include <tactnet/tactnet.hpp>
#include <tactnet/training.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

using net = tactnet::network<tactnet::shape{7, 13}, tactnet::conv2d<4, 3>, tactnet::batch_norm, tactnet::relu,
                             tactnet::max_pool<2>, tactnet::dense<2>>;

int main() {
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels;
    using namespace tactnet::simulation;
    scene<array<7, 13>, contact<winkler>, film_texture, saturation, quantisation<8>> scene;
    decltype(scene)::frames frames;
    for (std::uint32_t number = 0; number < 24; ++number) {
        const double radius = number % 2 == 0 ? 0.01 : 0.03;
        const touch ball{{{rod::sphere({}, radius)}, {}}, {}, pressing::to_force(1)};
        simulate(scene, ball, {}, frames);
        for (const float count : frames.measured)
            pixels.push_back(static_cast<std::uint8_t>(count));
        labels.push_back(number % 2);
    }

    const tactnet::labelled_images images{pixels, labels, 2};
    tactnet::recipe recipe = tactnet::recipe::default_for(7, 13);
    recipe.epochs = 1;
    tactnet::thread_pool threads(1);
    tactnet::trainer<net> training(
        recipe, images, tactnet::split_data(labels, 2, tactnet::split_rule::random, 1), 1, threads);
    training.run_epoch();
    const tactnet::model<net> model{training.best(), training.input_normalisation(), {"small", "large"}};
    const std::filesystem::path file = "warnings.safetensors";
    tactnet::save_model(file, model, {{"network", "own"}});
    const auto network = tactnet::deploy(tactnet::load_model<net>(file));

    std::array<std::uint8_t, 7 * 13> counts;
    std::copy_n(pixels.begin(), counts.size(), counts.begin());

    const std::vector<float> features(pixels.begin(), pixels.end());
    const tactnet::kernel_training_options<tactnet::rbf_kernel> options{.cost = 10};
    const auto trained =
        tactnet::train_kernel_machine(tactnet::feature_rows<7 * 13>(features), labels, options, threads);
    const auto predicted = trained.machine.predict(tactnet::feature_rows<7 * 13>(features), threads);
    return network.classify(counts) && predicted.size() == labels.size() ? 0 : 1;
}
