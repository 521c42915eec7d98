// The results of tactnet/decision.hpp on the paper's images: accuracy with faults of the sensor, with and
// without sensor_health; how well probabilities are calibrated; how many touches a decision takes. TactNet-6
// at 28 × 50 is trained for each blocked split with the default recipe, seeds 0, 1, …; temperatures are
// fitted on the validation images; everything is reported for the test images. About five seconds per split.
//
//     benchmark_decision FOLDER_OF_IMAGES [SPLITS]        20 splits by default

#include "../support/measure.hpp"

#include <tactnet/decision.hpp>
#include <tactnet/io/images/set.hpp>
#include <tactnet/tactnet.hpp>
#include <tactnet/training.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <decode_image.hpp>
#include <exception>
#include <functional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace {

using namespace tactnet;

constexpr shape array{28, 50};
constexpr std::size_t tactels = array.size(), classes = 22;
using net = tactnet6<array, classes>;
using frame = std::array<std::uint8_t, tactels>;

/// Returns `count` random tactels, which depend on the seed alone.
std::vector<std::size_t> some_tactels(std::size_t seed, std::size_t count) {
    std::vector<std::size_t> places(tactels);
    for (std::size_t i = 0; i < tactels; ++i)
        places[i] = i;
    std::shuffle(places.begin(), places.end(), std::mt19937(static_cast<std::uint32_t>(seed)));
    places.resize(count);
    return places;
}
frame with(frame of, const std::vector<std::size_t>& places, std::uint8_t count) {
    for (const std::size_t place : places)
        of[place] = count;
    return of;
}
frame mapped(frame of, const std::function<double(double)>& map) {
    for (std::uint8_t& count : of)
        count = static_cast<std::uint8_t>(std::clamp(std::round(map(count)), 0.0, 255.0));
    return of;
}
std::vector<std::size_t> row_of(std::size_t row) {
    std::vector<std::size_t> places;
    for (std::size_t column = 0; column < array.columns; ++column)
        places.push_back(row * array.columns + column);
    return places;
}

struct fault {
    const char* name;
    /// A frame as the faulty sensor of a split gives it.
    frame (*of)(const frame&, std::size_t split);
};
const std::array faults{
    fault{"none", [](const frame& f, std::size_t) { return f; }},
    fault{"one row stuck at 255",
          [](const frame& f, std::size_t split) { return with(f, row_of(7 * split % array.rows), 255); }},
    fault{"1 % of tactels stuck at 255",
          [](const frame& f, std::size_t split) { return with(f, some_tactels(split, 14), 255); }},
    fault{"5 % of tactels stuck at 255",
          [](const frame& f, std::size_t split) { return with(f, some_tactels(split, 70), 255); }},
    fault{"offset of 8 counts",
          [](const frame& f, std::size_t) { return mapped(f, [](double count) { return count + 8; }); }},
    fault{"gain 0.6",
          [](const frame& f, std::size_t) { return mapped(f, [](double count) { return 0.6 * count; }); }},
    fault{"one row dead",
          [](const frame& f, std::size_t split) { return with(f, row_of(7 * split % array.rows), 0); }},
    fault{"5 % of tactels dead",
          [](const frame& f, std::size_t split) { return with(f, some_tactels(split, 70), 0); }},
};

/// What a sensor sees that breaks after it has learnt its baseline: for each test image, in random order,
/// five frames of air and five of the touch, of which the last is recognised.
struct outcome {
    std::size_t raw = 0, clean = 0,
                found = 0; ///< right answers without and with the stage; faulty tactels found
    double seconds = 0;    ///< per frame in `clean`
};
outcome play(const fault& broken, std::size_t split, const deployed<net>& network, const image_set& images,
             std::vector<std::size_t> test, const force_statistics& trained) {
    std::shuffle(test.begin(), test.end(), std::mt19937(static_cast<std::uint32_t>(split)));
    sensor_health<array> health;
    contact_detector<array> detector;
    gain_monitor gain(trained);
    for (int i = 0; i < 50; ++i)
        health.learn(frame{});
    const frame air = broken.of(frame{}, split);
    outcome result;
    for (const std::size_t image : test) {
        frame raw{};
        std::copy_n(images.pixels.begin() + static_cast<std::ptrdiff_t>(image * tactels), tactels,
                    raw.begin());
        raw = broken.of(raw, split);
        for (int i = 0; i < 5; ++i)
            (void)detector.update(health.clean(air));
        for (int i = 0; i < 4; ++i)
            (void)detector.update(health.clean(raw));
        frame clean{};
        std::copy_n(health.clean(raw).begin(), tactels, clean.begin());
        gain.add_touch(detector.update(clean).force);
        clean = mapped(clean, [&](double count) { return count / gain.gain(); });
        const auto without = network.classify(raw), with_stage = network.classify(clean);
        result.raw += without && without->index == images.labels[image];
        result.clean += with_stage && with_stage->index == images.labels[image];
        if (image == test.back())
            result.seconds = benchmark::time_rounds(15,
                                                    [&] {
                                                        for (int i = 0; i < 1000; ++i)
                                                            (void)health.clean(raw);
                                                    })
                                 .median /
                             1000;
    }
    result.found = health.faults().size();
    return result;
}

std::vector<float> logits_of(const deployed<net>& network, const image_set& images,
                             std::span<const std::size_t> chosen) {
    std::vector<float> logits(chosen.size() * classes);
    for (std::size_t i = 0; i < chosen.size(); ++i)
        (void)network.infer(std::span(images.pixels).subspan(chosen[i] * tactels).first<tactels>(),
                            std::span(logits).subspan(i * classes).first<classes>());
    return logits;
}
std::vector<std::size_t> labels_of(const image_set& images, std::span<const std::size_t> chosen) {
    std::vector<std::size_t> labels;
    for (const std::size_t image : chosen)
        labels.push_back(images.labels[image]);
    return labels;
}

/// How often the right class is in a set, and how large sets are.
struct sets {
    double promised = 0;
    std::size_t held = 0, members = 0;
};

/// Test images of one object after the other until a decision.
struct sequential {
    double promised = 0;
    bool in_a_row = false; ///< as they were recorded, from a random one on; else in random order
    std::size_t objects = 0, touches = 0, wrong = 0, undecided = 0;

    void play(std::span<const float> logits, std::span<const std::size_t> labels,
              const temperature_scaling& scaling, std::mt19937& random) {
        for (std::size_t label = 0; label < classes; ++label) {
            std::vector<std::size_t> of_object;
            for (std::size_t i = 0; i < labels.size(); ++i)
                if (labels[i] == label)
                    of_object.push_back(i);
            if (in_a_row)
                std::rotate(of_object.begin(),
                            of_object.begin() + static_cast<std::ptrdiff_t>(random() % of_object.size()),
                            of_object.end());
            else
                std::shuffle(of_object.begin(), of_object.end(), random);
            touch_evidence<classes> evidence(classes, scaling);
            for (const std::size_t i : of_object) {
                (void)evidence.add_frame(logits.subspan(i * classes).first<classes>());
                evidence.end_grasp();
                if (evidence.decide(promised))
                    break;
            }
            const auto decision = evidence.decide(promised);
            ++objects;
            touches += evidence.grasps();
            undecided += !decision;
            wrong += decision && decision->index != label;
        }
    }
};

void run(const std::string& folder, std::size_t splits) {
    const image_set images = load_images(list_image_folder(folder), array.rows, array.columns, decode_image);
    const labelled_images data{images.pixels, images.labels, classes};
    thread_pool threads(1);
    std::array<outcome, faults.size()> sums{};
    reliability_diagram before, after;
    std::array<sets, 3> prediction_sets{{{0.9}, {0.95}, {0.98}}};
    std::vector<sequential> decisions;
    for (const double promised : {0.1, 0.05, 0.02, 0.01})
        for (const bool in_a_row : {false, true})
            decisions.push_back({promised, in_a_row});
    double temperatures = 0;
    std::size_t tested = 0;
    for (std::size_t split = 0; split < splits; ++split) {
        const data_split parts = split_data(images.labels, classes, split_rule::blocked, split);
        trainer<net> training(recipe::default_for(array.rows, array.columns), data, parts, split, threads);
        while (!training.finished())
            (void)training.run_epoch();
        const auto network = deploy(training.best(), training.input_normalisation().mean.view().elements(),
                                    training.input_normalisation().scale);
        std::vector<std::uint8_t> trained;
        for (const std::size_t image : parts.training)
            trained.insert(trained.end(),
                           images.pixels.begin() + static_cast<std::ptrdiff_t>(image * tactels),
                           images.pixels.begin() + static_cast<std::ptrdiff_t>((image + 1) * tactels));
        for (std::size_t f = 0; f < faults.size(); ++f) {
            const outcome one = play(faults[f], split, network, images, parts.test,
                                     force_statistics::of(trained, tactels, contact_settings{}.pressed));
            sums[f].raw += one.raw, sums[f].clean += one.clean, sums[f].found += one.found;
            sums[f].seconds += one.seconds;
        }
        const auto logits = logits_of(network, images, parts.test);
        const auto labels = labels_of(images, parts.test);
        const auto held_out = logits_of(network, images, parts.validation);
        const auto held_out_labels = labels_of(images, parts.validation);
        const temperature_scaling scaling = fit_temperature(held_out, classes, held_out_labels, classes);
        for (sets& each : prediction_sets) {
            const auto set =
                fit_prediction_set(scaling, each.promised, held_out, classes, held_out_labels, classes);
            for (std::size_t i = 0; i < labels.size(); ++i) {
                std::array<bool, classes> members{};
                each.members += set.predict(std::span(logits).subspan(i * classes, classes), members);
                each.held += members[labels[i]];
            }
        }
        temperatures += scaling.temperature;
        for (std::size_t i = 0; i < labels.size(); ++i)
            for (auto& [diagram, by] :
                 {std::pair<reliability_diagram&, temperature_scaling>(before, {}),
                  std::pair<reliability_diagram&, temperature_scaling>(after, scaling)}) {
                const auto found = by.classify(std::span(logits).subspan(i * classes, classes), classes);
                diagram.add(found->probability, found->index == labels[i]);
            }
        std::mt19937 random(static_cast<std::uint32_t>(split));
        for (sequential& each : decisions)
            for (int order = 0; order < 5; ++order)
                each.play(logits, labels, scaling, random);
        tested += parts.test.size();
        std::fprintf(stderr, "%zu of %zu splits\n", split + 1, splits);
    }
    const auto percent = [](std::size_t part, std::size_t of) {
        return 100 * static_cast<double>(part) / static_cast<double>(of);
    };
    const auto count = static_cast<double>(splits);
    std::printf("TactNet-6, 28 x 50, %zu blocked splits, %zu test images\n\n", splits, tested);
    std::printf("| fault | accuracy, %% | with sensor_health, %% | faulty tactels found | us per frame |\n");
    std::printf("|---|---|---|---|---|\n");
    for (std::size_t f = 0; f < faults.size(); ++f)
        std::printf("| %s | %.2f | %.2f | %.1f | %.2f |\n", faults[f].name, percent(sums[f].raw, tested),
                    percent(sums[f].clean, tested), static_cast<double>(sums[f].found) / count,
                    1e6 * sums[f].seconds / count);
    std::printf("\n| probabilities | calibration error, %% | Brier score |\n|---|---|---|\n");
    std::printf("| of the softmax | %.2f | %.4f |\n", 100 * before.calibration_error(), before.brier_score());
    std::printf("| at the fitted temperature, %.2f on average | %.2f | %.4f |\n", temperatures / count,
                100 * after.calibration_error(), after.brier_score());
    std::printf("\n| promised coverage, %% | coverage, %% | classes in a set |\n|---|---|---|\n");
    for (const sets& each : prediction_sets)
        std::printf("| %.0f | %.2f | %.3f |\n", 100 * each.promised, percent(each.held, tested),
                    static_cast<double>(each.members) / static_cast<double>(tested));
    std::printf(
        "\n| promised errors, %% | order | touches | wrong decisions, %% | undecided after ten, %% |\n"
        "|---|---|---|---|---|\n");
    for (const sequential& each : decisions)
        std::printf("| %.0f | %s | %.2f | %.2f | %.2f |\n", 100 * each.promised,
                    each.in_a_row ? "as recorded" : "random",
                    static_cast<double>(each.touches) / static_cast<double>(each.objects),
                    percent(each.wrong, each.objects), percent(each.undecided, each.objects));
}

} // namespace

int main(int count, char** given) {
    const int splits = count == 3 ? std::atoi(given[2]) : 20;
    if (count < 2 || count > 3 || splits < 1) {
        std::fprintf(stderr, "usage: benchmark_decision FOLDER_OF_IMAGES [SPLITS]\n");
        return 2;
    }
    try {
        run(given[1], static_cast<std::size_t>(splits));
    } catch (const std::exception& error) {
        std::fprintf(stderr, "benchmark_decision: %s\n", error.what());
        return 2;
    }
}
