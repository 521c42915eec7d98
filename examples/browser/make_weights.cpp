// Trains the networks of the page on simulated touches alone, and writes their weights in the page's format:
//
//     make_weights WEIGHTS [EPOCHS]
//
// EPOCHS, a percentage of those of the default recipe, is 10. The same seed gives the same bytes on any
// number of threads, for one instruction set. It prints how many touches of a further seed each network
// recognises.

#include "networks.hpp"
#include "weights.hpp"

#include <tactnet/decision.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/quantisation.hpp>
#include <tactnet/simulation.hpp>
#include <tactnet/training.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <numeric>
#include <string>
#include <vector>

namespace {

using namespace tactnet;

constexpr std::uint64_t training_seed = 1, test_seed = 3;          // touches on the page have seed 2
constexpr std::uint32_t training_touches = 400, test_touches = 50; // per class

struct touches {
    std::vector<std::uint8_t> pixels{};
    std::vector<std::size_t> labels{};
};

touches simulate(std::uint64_t seed, std::uint32_t per_class) {
    touches result;
    simulation::paper_scene scene;
    simulation::paper_scene::frames frame;
    for (std::size_t label = 0; label < browser::classes; ++label)
        for (std::uint32_t number = 0; number < per_class; ++number) {
            simulate_paper_touch(scene, label, seed, number, frame);
            for (const float count : frame.measured)
                result.pixels.push_back(saturate_to_count(count));
            result.labels.push_back(label);
        }
    return result;
}

template <shape Shape>
std::vector<std::uint8_t> reduced(const std::vector<std::uint8_t>& images) {
    constexpr std::size_t from = browser::array_shape.size();
    std::vector<std::uint8_t> small(images.size() / from * Shape.size());
    for (std::size_t i = 0; i < images.size() / from; ++i)
        resize<browser::array_shape, Shape>(
            tensor_view<const std::uint8_t, browser::array_shape>(images.data() + i * from),
            tensor_view<std::uint8_t, Shape>(small.data() + i * Shape.size()));
    return small;
}

/// Sets weights to zero that meet nothing but padding, so that they compress. No output changes.
template <class Steps, std::size_t Index = 0>
void clear_unused_weights(float* folded) {
    if constexpr (Index < Steps::size) {
        using step = typename Steps::template at<Index>;
        if constexpr (requires { step::kernel.window; }) {
            constexpr auto window = step::kernel.window;
            const auto is_used = [](std::size_t place, std::size_t kernel, std::size_t input) {
                const std::size_t before = (kernel - 1) / 2;
                return (place > before ? place - before : before - place) < input;
            };
            for (std::size_t i = 0; i < step::weights; ++i)
                if (!is_used(i / window.kernel.columns % window.kernel.rows, window.kernel.rows,
                             window.input.rows) ||
                    !is_used(i % window.kernel.columns, window.kernel.columns, window.input.columns))
                    folded[i] = 0;
        }
        clear_unused_weights<Steps, Index + 1>(folded + step::folded_elements);
    }
}

/// Rounds the weights of large layers to every fourth step, of the largest to every eighth, so that they
/// compress: most of the page is made of them.
template <class Network>
void coarsen_large_layers(browser::stored_network<Network>& network) {
    constexpr std::size_t large = 4'000, largest = 30'000;
    constexpr float most = 120; // of 127
    for (const folded_step& step :
         folded_layout_of<typename browser::stored_network<Network>::bytes_view>().steps) {
        const auto &weights = *step.find("weight"), &scales = *step.find("scale");
        const float coarse = weights.size > largest ? 8 : 4;
        for (std::size_t i = 0; weights.size > large && i < weights.size; ++i) {
            const float scale = network.in_bytes[scales.offset + i / (weights.size / scales.size)];
            float& weight = network.in_bytes[weights.offset + i];
            weight = std::clamp(coarse * std::nearbyint(weight / scale / coarse), -most, most) * scale;
        }
    }
}

/// Logits of all images.
template <class Network, class Format>
std::vector<float> logits_of(const deployed<Network, Format>& network,
                             const std::vector<std::uint8_t>& images) {
    thread_pool threads(1);
    std::vector<float> logits(images.size() / Network::input_shape.size() * Network::outputs);
    if (network.infer(images, logits, threads) != frame_status::ok)
        throw std::runtime_error("weights: a network gives outputs that are not finite");
    return logits;
}
double accuracy(std::span<const float> logits, std::span<const std::size_t> labels) {
    std::size_t right = 0;
    for (std::size_t i = 0; i < labels.size(); ++i)
        right += first_largest(logits.subspan(i * browser::classes, browser::classes)) == labels[i];
    return 100 * static_cast<double>(right) / static_cast<double>(labels.size());
}

/// Trains a network and appends it.
template <class Network>
void train(std::string_view family, std::size_t percent, const touches& learnt, const touches& unseen,
           browser::detail::byte_writer& to) {
    constexpr shape input = Network::input_shape;
    const auto pixels = reduced<input>(learnt.pixels), test = reduced<input>(unseen.pixels);
    labelled_images images{pixels, learnt.labels, browser::classes};
    if constexpr (input != browser::array_shape)
        images.taken = images_as_taken::of<browser::array_shape, input>(learnt.pixels);

    recipe how = recipe::default_for(input.rows, input.columns);
    how.epochs = std::max<std::size_t>(how.epochs * percent / 100, 1);
    // The last twentieth of each class chooses the epoch and the temperature.
    data_split split;
    for (std::size_t i = 0; i < learnt.labels.size(); ++i)
        (i % training_touches < training_touches * 19 / 20 ? split.training : split.validation).push_back(i);
    thread_pool threads(1);
    trainer<Network> training(how, images, split, training_seed, threads);
    while (!training.finished())
        training.run_epoch();

    normalisation<input> normalise = training.input_normalisation();
    for (float& count : normalise.mean)
        count = std::nearbyint(count * browser::mean_steps) / browser::mean_steps;
    const auto mean = normalise.mean.view().elements();
    const deployed<Network> trained(training.best(), mean, normalise.scale);
    // Images are in the order of their classes, and calibration wants its held-out ones to be others.
    std::vector<std::uint8_t> calibration;
    for (std::size_t i = 0; i < 1024; ++i) {
        const std::size_t image = split.training[i * 4099 % split.training.size()];
        calibration.insert(calibration.end(),
                           pixels.begin() + static_cast<std::ptrdiff_t>(image * input.size()),
                           pixels.begin() + static_cast<std::ptrdiff_t>((image + 1) * input.size()));
    }
    const eight_bit_calibration<Network> found(training.best(), mean, normalise.scale, calibration);

    browser::stored_network<Network> stored;
    using view = typename browser::stored_network<Network>::bytes_view;
    std::copy(found.folded().begin(), found.folded().end(), stored.in_bytes.begin());
    clear_unused_weights<typename view::steps>(stored.in_bytes.data() + view::steps_folded);
    coarsen_large_layers(stored);
    stored.scale = trained.folded()[input.size()], stored.limit = trained.folded()[input.size() + 1];

    const auto in_floats = stored.in_floats();
    using floats_view = typename browser::stored_network<Network>::float_view;
    const deployed<Network> floats(
        std::span<const float, floats_view::folded_elements>(in_floats.data(), in_floats.size()));
    const deployed<Network, eight_bit> bytes(
        std::span<const float, view::folded_elements>(stored.in_bytes.data(), stored.in_bytes.size()));
    std::vector<std::uint8_t> held_out;
    std::vector<std::size_t> labels;
    for (const std::size_t image : split.validation) {
        held_out.insert(held_out.end(), pixels.begin() + static_cast<std::ptrdiff_t>(image * input.size()),
                        pixels.begin() + static_cast<std::ptrdiff_t>((image + 1) * input.size()));
        labels.push_back(learnt.labels[image]);
    }
    stored.temperature = static_cast<float>(
        fit_temperature(logits_of(floats, held_out), browser::classes, labels, browser::classes).temperature);
    browser::detail::move_network(stored, to);
    std::printf("%.*s,%zu,%zu,%.2f,%.2f,%.2f\n", static_cast<int>(family.size()), family.data(), input.rows,
                input.columns, accuracy(logits_of(trained, test), unseen.labels),
                accuracy(logits_of(floats, test), unseen.labels),
                accuracy(logits_of(bytes, test), unseen.labels));
    std::fflush(stdout);
}

} // namespace

int main(int count, char** arguments) {
    const int percent = count == 3 ? std::atoi(arguments[2]) : 10;
    if (count < 2 || count > 3 || percent < 1 || percent > 100) {
        std::fprintf(stderr, "weights: expected the file to write, then at most a percentage of epochs\n");
        return 2;
    }
    try {
        const touches learnt = simulate(training_seed, training_touches),
                      unseen = simulate(test_seed, test_touches);
        browser::detail::byte_writer to;
        std::puts("network,rows,columns,as trained %,stored weights %,8 bits %");
        std::apply(
            [&](const auto&... listed) {
                (train<typename std::remove_cvref_t<decltype(listed)>::network>(
                     listed.family, static_cast<std::size_t>(percent), learnt, unseen, to),
                 ...);
            },
            browser::networks);
        write_file(arguments[1], std::string(to.bytes.begin(), to.bytes.end()));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "weights: %s\n", error.what());
        return 1;
    }
    return 0;
}
