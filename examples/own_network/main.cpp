// tactnet_own_network: a network of your own, trained on simulated images and deployed. Copy it, and change
// `own_network`. Exit status: 0 if the deployed network recognises most images that it has not seen, else 1.

#include <tactnet/simulation.hpp>
#include <tactnet/tactnet.hpp>
#include <tactnet/training.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <vector>

namespace {

using namespace tactnet;

constexpr std::size_t classes = 6; // the first of the paper's
constexpr shape extents{14, 25};

/// Layers in order, without sizes: they follow from the image when this is compiled.
using own_network = network<extents,                                                   //
                            conv2d<8, 3>, batch_norm, relu, max_pool<2>,               // 7 × 13, 8 channels
                            residual<sequence<conv2d<8, 3>, batch_norm>>, relu,        // the same
                            conv2d<16, extent2d{2, 3}>, batch_norm, relu, max_pool<2>, // 4 × 7, 16 channels
                            dropout<20>, dense<classes>>;
// What it costs is known before it runs; a change that costs more is seen when compiling.
static_assert(own_network::parameters == 4206);
static_assert(own_network::multiply_adds == 150192);
static_assert(own_network::activation_bytes == 23824);

/// Touches of the paper's objects on an array of half the paper's resolution, as 8-bit counts.
using half_array = simulation::scene<simulation::array<28, 50>, simulation::contact<simulation::winkler>,
                                     simulation::elastic_pad, simulation::saturation,
                                     simulation::quantisation<8>, simulation::resolution<14, 25>>;

struct images {
    std::vector<std::uint8_t> pixels; // image after image, row by row
    std::vector<std::size_t> labels;
};

images simulate_images(std::uint32_t per_class) {
    images result;
    half_array scene;
    half_array::frames frames;
    for (std::size_t label = 0; label < classes; ++label)
        for (std::uint32_t number = 0; number < per_class; ++number) {
            simulation::simulate_paper_touch(scene, label, 1, number, frames);
            for (const float count : frames.measured)
                result.pixels.push_back(saturate_to_count(count));
            result.labels.push_back(label);
        }
    return result;
}

} // namespace

int main() {
    const images data = simulate_images(100);
    const labelled_images views{data.pixels, data.labels, classes};
    const data_split split = split_data(data.labels, classes, split_rule::random, 1);

    thread_pool threads(2);
    recipe how = recipe::default_for(extents.rows, extents.columns);
    how.epochs = 12;
    trainer<own_network> training(how, views, split, 1, threads);
    while (!training.finished())
        training.run_epoch();

    const auto& input = training.input_normalisation();
    const auto deployed = deploy(training.best(), input.mean.view().elements(), input.scale);
    std::size_t right = 0;
    for (const std::size_t index : split.test) {
        const tensor_view<const std::uint8_t, extents> frame(views.image<extents>(index));
        const auto found = deployed.classify(frame);
        if (!found)
            return 1;
        right += found->index == data.labels[index];
    }
    std::printf(
        "%zu of %zu test images recognised, %zu parameters, %zu multiply-adds, %zu bytes of weights\n", right,
        split.test.size(), own_network::parameters, own_network::multiply_adds, deployed.weight_bytes);
    return 2 * right > split.test.size() ? 0 : 1;
}
