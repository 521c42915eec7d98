// Measures unknown and new objects on the paper's images: how well each score separates unknown objects from
// known ones, and how often a new object is recognised after learning five touches. For each draw, TactNet-6
// at 28 × 50 is trained on 17 of the 22 objects, with a blocked split; the other five are unknown. Nothing is
// chosen by test images.
//
//     benchmark_new_objects FOLDER_OF_IMAGES [DRAWS] [thorough]        20 draws by default

#include <tactnet/decision.hpp>
#include <tactnet/io/images/set.hpp>
#include <tactnet/tactnet.hpp>
#include <tactnet/training.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <decode_image.hpp>
#include <exception>
#include <memory>
#include <numeric>
#include <random>
#include <span>
#include <string>
#include <vector>

namespace {

using namespace tactnet;

constexpr shape array{28, 50};
constexpr std::size_t tactels = array.size(), objects = 22, known_objects = 17,
                      dimensions = known_objects - 1;
using net = tactnet6<array, known_objects>;
using deployed_net = deployed<net>;
constexpr std::size_t features = deployed_net::features;
using projection = discriminant<features, dimensions>;

/// What a network makes of an image.
struct touch {
    std::array<float, known_objects> logits{};
    std::array<float, features> values{};
};
std::vector<touch> touches_of(const deployed_net& network, std::span<const std::uint8_t> pixels) {
    std::vector<touch> found(pixels.size() / tactels);
    const auto memory = std::make_unique<deployed_net::workspace>();
    for (std::size_t i = 0; i < found.size(); ++i) {
        (void)network.infer(pixels.subspan(i * tactels).first<tactels>(), found[i].logits, *memory);
        network.read_features(*memory, found[i].values);
    }
    return found;
}

/// Larger for objects that are known.
using score = double (*)(const touch&, const projection&, const class_means<dimensions, objects>&);
double norm(std::span<const float> values) {
    return std::sqrt(std::accumulate(values.begin(), values.end(), 0.0, [](double sum, float value) {
        return sum + static_cast<double>(value) * static_cast<double>(value);
    }));
}
struct named_score {
    const char* name;
    score of;
};
const std::array scores{
    named_score{"largest softmax (Hendrycks and Gimpel, 2017)",
                [](const touch& t, const auto&, const auto&) {
                    return classify_logits(t.logits, known_objects)->probability;
                }},
    named_score{"energy (Liu et al., 2020)",
                [](const touch& t, const auto&, const auto&) {
                    const double largest =
                        static_cast<double>(*std::max_element(t.logits.begin(), t.logits.end()));
                    double sum = 0;
                    for (const float logit : t.logits)
                        sum += std::exp(static_cast<double>(logit) - largest);
                    return largest + std::log(sum);
                }},
    named_score{"largest logit / norm of the features",
                [](const touch& t, const auto&, const auto&) {
                    return static_cast<double>(*std::max_element(t.logits.begin(), t.logits.end())) /
                           norm(t.values);
                }},
    named_score{"distance to the nearest mean, discriminant",
                [](const touch& t, const projection& map, const class_means<dimensions, objects>& means) {
                    return -means.nearest(map(t.values))->squared_distance;
                }},
};

struct curve {
    double area = 0;     ///< under the receiver's operating characteristic
    double accepted = 0; ///< share of unknown objects, where 95 % of known ones are
};
curve curve_of(std::vector<double> known, const std::vector<double>& unknown) {
    std::sort(known.begin(), known.end());
    const double least = known[known.size() / 20];
    curve found;
    for (const double one : unknown) {
        const auto [first, last] = std::equal_range(known.begin(), known.end(), one);
        found.area += static_cast<double>(known.end() - last) + static_cast<double>(last - first) / 2;
        found.accepted += one >= least;
    }
    const auto count = static_cast<double>(unknown.size());
    return {found.area / count / static_cast<double>(known.size()), found.accepted / count};
}

struct sums {
    double sum = 0, squares = 0;
    std::size_t count = 0;
    void add(double value) { sum += value, squares += value * value, ++count; }
    [[nodiscard]] double mean() const { return sum / static_cast<double>(count); }
    [[nodiscard]] double deviation() const {
        return std::sqrt(std::max(0.0, squares / static_cast<double>(count) - mean() * mean()));
    }
};

/// Shares of touches by the logarithm of their distance, for a picture.
struct histogram {
    static constexpr double lowest = 1, highest = 6, width = 0.25;
    std::array<sums, static_cast<std::size_t>((highest - lowest) / width)> bins;

    void add(double squared_distance) {
        const double place = (std::log(squared_distance) - lowest) / width;
        const auto bin =
            static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(bins.size() - 1)));
        for (std::size_t b = 0; b < bins.size(); ++b)
            bins[b].add(b == bin ? 100 : 0);
    }
};

void run(const std::string& folder, std::size_t draws, bool thorough) {
    const image_set images = load_images(list_image_folder(folder), array.rows, array.columns, decode_image);
    thread_pool threads(1);
    std::array<sums, scores.size()> areas, accepted;
    histogram of_known_touches, of_unknown_touches;
    sums accuracy, by_means, alarms, unnoticed, blocked_new, blocked_old, random_new, learning;
    for (std::size_t draw = 0; draw < draws; ++draw) {
        std::mt19937 random(static_cast<std::uint32_t>(draw));
        std::vector<std::size_t> order(objects);
        std::iota(order.begin(), order.end(), 0U);
        std::shuffle(order.begin(), order.end(), random);
        std::sort(order.begin(), order.begin() + known_objects);
        std::vector<std::uint8_t> pixels;
        std::vector<std::size_t> labels;
        for (std::size_t c = 0; c < known_objects; ++c)
            for (std::size_t i = 0; i < images.labels.size(); ++i)
                if (images.labels[i] == order[c]) {
                    const auto first = images.pixels.begin() + static_cast<std::ptrdiff_t>(i * tactels);
                    pixels.insert(pixels.end(), first, first + tactels);
                    labels.push_back(c);
                }
        const labelled_images data{pixels, labels, known_objects};
        const data_split split = split_data(labels, known_objects, split_rule::blocked, draw);
        recipe settings = recipe::default_for(array.rows, array.columns);
        trainer<net> training(thorough ? settings.thorough() : settings, data, split, draw, threads);
        while (!training.finished())
            (void)training.run_epoch();
        const auto network = deploy(training.best(), training.input_normalisation().mean.view().elements(),
                                    training.input_normalisation().scale);
        const std::vector<touch> known = touches_of(network, pixels),
                                 all = touches_of(network, images.pixels);

        std::vector<float> rows;
        std::vector<std::size_t> row_labels;
        for (const std::size_t i : split.training) {
            rows.insert(rows.end(), known[i].values.begin(), known[i].values.end());
            row_labels.push_back(labels[i]);
        }
        const auto map = fit_discriminant<features, dimensions>(rows, row_labels, known_objects);
        class_means<dimensions, objects> means;
        for (const std::size_t i : split.training)
            (void)means.learn(labels[i], (*map)(known[i].values));
        std::vector<double> distances;
        for (const std::size_t i : split.validation)
            distances.push_back(means.nearest((*map)(known[i].values))->squared_distance);
        const double largest = fit_largest_distance(distances, 0.05);

        std::vector<std::size_t> unknown;
        for (std::size_t i = 0; i < images.labels.size(); ++i)
            if (std::find(order.begin(), order.begin() + known_objects, images.labels[i]) ==
                order.begin() + known_objects)
                unknown.push_back(i);
        for (std::size_t s = 0; s < scores.size(); ++s) {
            std::vector<double> of_known, of_unknown;
            for (const std::size_t i : split.test)
                of_known.push_back(scores[s].of(known[i], *map, means));
            for (const std::size_t i : unknown)
                of_unknown.push_back(scores[s].of(all[i], *map, means));
            const curve found = curve_of(of_known, of_unknown);
            areas[s].add(100 * found.area);
            accepted[s].add(100 * found.accepted);
        }
        for (const std::size_t i : split.test) {
            const auto nearest = means.nearest((*map)(known[i].values));
            accuracy.add(100.0 * (classify_logits(known[i].logits, known_objects)->index == labels[i]));
            by_means.add(100.0 * (nearest->index == labels[i]));
            alarms.add(100.0 * (nearest->squared_distance > largest));
            of_known_touches.add(nearest->squared_distance);
        }
        for (const std::size_t i : unknown) {
            const double distance = means.nearest((*map)(all[i].values))->squared_distance;
            unnoticed.add(100.0 * (distance <= largest));
            of_unknown_touches.add(distance);
        }

        // Each unknown object by itself: learnt from five touches in a row, of which the next ten are left
        // out, and tried on twenty; and the same with touches in any order.
        for (std::size_t object = known_objects; object < objects; ++object) {
            std::vector<std::size_t> of_object;
            for (const std::size_t i : unknown)
                if (images.labels[i] == order[object])
                    of_object.push_back(i);
            std::rotate(of_object.begin(),
                        of_object.begin() + static_cast<std::ptrdiff_t>(random() % of_object.size()),
                        of_object.end());
            for (const bool blocked : {true, false}) {
                if (!blocked)
                    std::shuffle(of_object.begin(), of_object.end(), random);
                std::array<class_means<dimensions, objects>::point, 5> points{};
                for (std::size_t i = 0; i < 5; ++i)
                    points[i] = (*map)(all[of_object[i]].values);
                const auto start = std::chrono::steady_clock::now();
                for (const auto& point : points)
                    (void)means.learn(known_objects, point);
                learning.add(
                    std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
                        .count());
                for (std::size_t i = 15; i < 35; ++i)
                    (blocked ? blocked_new : random_new)
                        .add(100.0 *
                             (means.nearest((*map)(all[of_object[i]].values))->index == known_objects));
                if (blocked)
                    for (const std::size_t i : split.test)
                        blocked_old.add(100.0 * (means.nearest((*map)(known[i].values))->index == labels[i]));
                means.forget(known_objects);
            }
        }
        std::fprintf(stderr, "%zu of %zu draws\n", draw + 1, draws);
    }
    std::printf("TactNet-6, 28 x 50, %s recipe, %zu draws of %zu of %zu objects\n\n",
                thorough ? "thorough" : "default", draws, known_objects, objects);
    std::printf("| score | area under the curve, %% | unknown accepted where 95 %% of known are, %% "
                "|\n|---|---|---|\n");
    for (std::size_t s = 0; s < scores.size(); ++s)
        std::printf("| %s | %.2f ± %.2f | %.1f |\n", scores[s].name, areas[s].mean(), areas[s].deviation(),
                    accepted[s].mean());
    std::printf("\nA threshold for 5 %% of false alarms, by validation images: %.1f %% of known touches "
                "rejected, %.1f %% "
                "of unknown ones accepted.\n",
                alarms.mean(), unnoticed.mean());
    std::printf("\n| touches | right, %% |\n|---|---|\n");
    std::printf("| of known objects, by the network | %.2f |\n", accuracy.mean());
    std::printf("| of known objects, by the nearest mean | %.2f |\n", by_means.mean());
    std::printf("| the same, once a new object is learnt | %.2f |\n", blocked_old.mean());
    std::printf("| of the new object, five touches in a row learnt | %.1f |\n", blocked_new.mean());
    std::printf("| of the new object, five touches in any order learnt | %.1f |\n", random_new.mean());
    std::printf("\nLearning five touches takes %.2f us.\n", learning.mean());
    std::printf("\n| distance to the nearest mean, from | known touches, %% | unknown touches, %% "
                "|\n|---|---|---|\n");
    for (std::size_t b = 0; b < of_known_touches.bins.size(); ++b)
        std::printf("| %.2f | %.1f | %.1f |\n",
                    std::exp((histogram::lowest + static_cast<double>(b) * histogram::width) / 2),
                    of_known_touches.bins[b].mean(), of_unknown_touches.bins[b].mean());
}

} // namespace

int main(int count, char** given) {
    const int draws = count > 2 ? std::atoi(given[2]) : 20;
    const bool thorough = count == 4 && std::strcmp(given[3], "thorough") == 0;
    if (count < 2 || count > 4 || draws < 1 || (count == 4 && !thorough)) {
        std::fprintf(stderr, "usage: benchmark_new_objects FOLDER_OF_IMAGES [DRAWS] [thorough]\n");
        return 2;
    }
    try {
        run(given[1], static_cast<std::size_t>(draws), thorough);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "benchmark_new_objects: %s\n", error.what());
        return 2;
    }
}
