// Simulated touches, from the first to a network that was trained beside objects of no class.

#include <tactnet/deployment.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators.hpp>
#include <tactnet/simulation/paper/objects.hpp>
#include <tactnet/training/data/split.hpp>
#include <tactnet/training/trainer.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

using namespace tactnet;
using namespace tactnet::simulation;

namespace {

constexpr shape half{14, 25};
constexpr std::array<std::size_t, 3> objects_known{0, 7, 19}; // adhesive, cable, scissors
constexpr std::size_t known = objects_known.size(), touches = 96, outliers = 96;
using small_net = network<half, conv2d<8, 5>, batch_norm, relu, max_pool<2>, conv2d<8, 3>, batch_norm, relu,
                          max_pool<2>, dense<known>>;
using image = std::array<std::uint8_t, half.size()>;

/// An object that is none of the paper's: one to three bars, rings and balls side by side.
touch draw_outlier(std::uint32_t number) {
    const auto stream = [&](std::uint32_t what) {
        return random_stream(1, random_purposes::touch, number, 1'000'000 + what);
    };
    drawing random(stream(0), stream(1), stream(2));
    object body;
    for (std::size_t parts = random.count(1, 3); parts > 0; --parts) {
        const point at{random.around(0, 18) * mm, random.around(0, 10) * mm};
        const std::size_t kind = random.count(0, 2);
        if (kind == 0) {
            const point along = random.within(5, 30) * mm * point::at_angle(random.within(0, 360) * degrees);
            body.parts.push_back(rod{at, at + along, random.within(2, 12) * mm, random.within(2, 12) * mm});
        } else if (kind == 1)
            body.parts.push_back(arc{at, random.within(6, 16) * mm, random.within(2, 6) * mm});
        else
            body.parts.push_back(rod::sphere(at, random.within(8, 40) * mm));
    }
    return {.shape = body,
            .at = random.somewhere({.middle = {}, .reach = {8 * mm, 5 * mm}}),
            .press = random.pressed(5, 20)};
}

/// Simulates touches at 28 × 50 and takes the mean of each 2 × 2 tactels.
class simulator {
public:
    image known_touch(std::size_t c, std::uint32_t number) {
        simulate_paper_touch(scene_, objects_known[c], 1, number, frames_);
        return reduced();
    }
    image outlier(std::uint32_t number) {
        scene_.use(sensor_unit{number});
        simulate(scene_, draw_outlier(number), {.seed = number, .frame = number}, frames_);
        return reduced();
    }

private:
    image reduced() const {
        image small{};
        for (std::size_t y = 0; y < half.rows; ++y)
            for (std::size_t x = 0; x < half.columns; ++x) {
                const auto at = [&](std::size_t dy, std::size_t dx) {
                    return static_cast<unsigned>(frames_.measured(2 * y + dy, 2 * x + dx));
                };
                small[y * half.columns + x] =
                    static_cast<std::uint8_t>((at(0, 0) + at(0, 1) + at(1, 0) + at(1, 1)) / 4);
            }
        return small;
    }

    paper_scene scene_;
    paper_scene::frames frames_;
};

struct outcome {
    double accuracy = 0; ///< on touches of known objects that were not trained on
    double area = 0;     ///< under the receiver operating characteristic of the probability
};

/// Trains on touches of known objects and, labelled `no_class`, the others; `strangers` are tested only.
outcome train(const std::vector<image>& of_known, const std::vector<image>& others,
              const std::vector<image>& strangers) {
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels;
    data_split split;
    for (std::size_t i = 0; i < of_known.size(); ++i) {
        pixels.insert(pixels.end(), of_known[i].begin(), of_known[i].end());
        labels.push_back(i % known);
        (i < of_known.size() / 2 ? split.training : split.test).push_back(i);
    }
    for (const image& other : others) {
        pixels.insert(pixels.end(), other.begin(), other.end());
        split.training.push_back(labels.size());
        labels.push_back(no_class);
    }
    recipe settings = recipe::default_for(half.rows, half.columns);
    settings.epochs = 150;
    const labelled_images data{pixels, labels, known};
    thread_pool alone;
    trainer<small_net> training(settings, data, split, 1, alone);
    while (!training.finished())
        (void)training.run_epoch();
    const auto network = deploy(training.best(), training.input_normalisation().mean.view().elements(),
                                training.input_normalisation().scale);

    outcome found;
    std::vector<double> scores;
    for (const std::size_t i : split.test) {
        std::array<float, known> logits{};
        REQUIRE(network.infer(of_known[i], logits) == frame_status::ok);
        const auto recognised = classify_logits(logits, known);
        scores.push_back(1 - static_cast<double>(recognised->probability));
        found.accuracy += recognised->index == labels[i];
    }
    found.accuracy /= static_cast<double>(scores.size());
    for (const image& stranger : strangers) {
        std::array<float, known> logits{};
        REQUIRE(network.infer(stranger, logits) == frame_status::ok);
        const double score = 1 - static_cast<double>(classify_logits(logits, known)->probability);
        found.area += static_cast<double>(
            std::count_if(scores.begin(), scores.end(), [&](double other) { return other < score; }));
    }
    found.area /= static_cast<double>(scores.size() * strangers.size());
    return found;
}

} // namespace

TEST_CASE("trainer: beside objects of no class, a network becomes unsure of objects that it never saw") {
    simulator sensor;
    std::vector<image> of_known, others, strangers;
    for (std::uint32_t number = 0; number < touches; ++number)
        for (std::size_t c = 0; c < known; ++c)
            of_known.push_back(sensor.known_touch(c, number));
    for (std::uint32_t number = 0; number < outliers; ++number) {
        others.push_back(sensor.outlier(number));
        strangers.push_back(sensor.outlier(outliers + number));
    }
    const outcome without = train(of_known, {}, strangers), with = train(of_known, others, strangers);
    // Half the errors, or less; if the training left the others out, as many.
    CHECK(1 - with.area < (1 - without.area) / 2);
    CHECK(with.accuracy > 2.0 / 3); // twice as often as by chance
}
