// Measures unknown and new objects on the paper's images: how well the distance to class means separates
// unknown objects from known ones, and how often a new object is recognised after learning five touches. For
// each draw, TactNet-6 at 28 × 50 is trained on 17 of the 22 objects, with a blocked split; the other five
// are unknown. Nothing is chosen by test images.
//
//     benchmark_new_objects FOLDER_OF_IMAGES [DRAWS [default|thorough [NETWORKS]]]     20 draws by default
//
// Trained networks are kept in the folder NETWORKS, and taken from there: to compare scores takes a minute.

#include <tactnet/decision.hpp>
#include <tactnet/deployment/reflection_average.hpp>
#include <tactnet/io/images/set.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/save_model.hpp>
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
#include <filesystem>
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

/// The outputs of a network for an image, or for an image and its reflections.
struct response {
    std::array<float, known_objects> logits{};
    std::array<float, features> values{};
};
struct touch {
    response alone, reflected;       ///< of a single view, and the mean of four
    std::array<response, 4> views{}; ///< of the image and each reflection
};
std::vector<touch> touches_of(const deployed_net& network, std::span<const std::uint8_t> pixels) {
    std::vector<touch> found(pixels.size() / tactels);
    const auto memory = std::make_unique<deployed_net::workspace>();
    using four_views = reflection_average<deployed_net::view_type>;
    const four_views average(network.view());
    const auto average_memory = std::make_unique<four_views::workspace>();
    for (std::size_t i = 0; i < found.size(); ++i) {
        const auto image = pixels.subspan(i * tactels).first<tactels>();
        for (std::size_t view = 0; view < 4; ++view) {
            response& one = found[i].views[view];
            std::array<std::uint8_t, tactels> seen;
            reflect_image(array, all_reflections[view], image.data(), seen.data());
            (void)network.infer(seen, one.logits, *memory);
            network.read_features(*memory, one.values);
        }
        found[i].alone = found[i].views[0];
        (void)average.infer(image, found[i].reflected.logits, found[i].reflected.values, *average_memory);
    }
    return found;
}

/// Features to fit a discriminant to.
struct fitting_rows {
    std::vector<float> values;
    std::vector<std::size_t> labels;
    void add(const response& one, std::size_t label) {
        values.insert(values.end(), one.values.begin(), one.values.end());
        labels.push_back(label);
    }
};
/// A discriminant and the means of classes in its dimensions.
struct fitted {
    std::unique_ptr<projection> map;
    class_means<dimensions, objects> means;

    [[nodiscard]] projection::point point(const response& one) const { return map->project(one.values); }
    [[nodiscard]] nearest_class nearest(const response& one) const { return *means.nearest(point(one)); }
};
/// By single views of the training images.
fitted fit_single_views(const std::vector<touch>& touches, std::span<const std::size_t> labels,
                        std::span<const std::size_t> training) {
    fitting_rows rows;
    for (const std::size_t i : training)
        rows.add(touches[i].alone, labels[i]);
    fitted result{fit_discriminant<features, dimensions>(rows.values, rows.labels, known_objects), {}};
    for (const std::size_t i : training)
        (void)result.means.learn(labels[i], result.point(touches[i].alone));
    return result;
}
/// By all views of the training images and of images that the network was not trained on, which vary within
/// classes as touches to come do: these count four times, as much as all training images together.
fitted fit_all_views(const std::vector<touch>& touches, std::span<const std::size_t> labels,
                     std::span<const std::size_t> training, std::span<const std::size_t> held_out) {
    fitting_rows rows;
    for (const std::size_t i : training)
        for (const response& view : touches[i].views)
            rows.add(view, labels[i]);
    for (const std::size_t i : held_out)
        for (int time = 0; time < 4; ++time)
            for (const response& view : touches[i].views)
                rows.add(view, labels[i]);
    fitted result{fit_discriminant<features, dimensions>(rows.values, rows.labels, known_objects), {}};
    for (const auto& part : {training, held_out})
        for (const std::size_t i : part)
            (void)result.means.learn(labels[i], result.point(touches[i].reflected));
    return result;
}

/// Every second block of four of the validation images, which has four of each class: neighbours stay
/// together.
std::vector<std::size_t> half_of(std::span<const std::size_t> validation, bool second) {
    std::vector<std::size_t> half;
    for (std::size_t i = 0; i < validation.size(); ++i)
        if ((i / 4 % 2 == 1) == second)
            half.push_back(validation[i]);
    return half;
}

/// The scores that are compared, of single views and of reflections.
struct named_score {
    const char* name;
    double (*of)(const touch&, const fitted& single, const fitted& all);
};
double probability_of(const response& one) {
    return static_cast<double>(classify_logits(one.logits, known_objects)->probability);
}
const std::array scores{
    named_score{"largest softmax (Hendrycks and Gimpel, 2017)",
                [](const touch& t, const auto&, const auto&) { return -probability_of(t.alone); }},
    named_score{"distance / spread of the class",
                [](const touch& t, const auto& single, const auto&) {
                    return single.nearest(t.alone).relative_distance;
                }},
    named_score{
        "the same, means and spreads also of held-out images",
        [](const touch& t, const auto&, const auto& all) { return all.nearest(t.alone).relative_distance; }},
    named_score{"largest softmax, four reflections",
                [](const touch& t, const auto&, const auto&) { return -probability_of(t.reflected); }},
    named_score{"distance / spread, four reflections, also of held-out images",
                [](const touch& t, const auto&, const auto& all) {
                    return all.nearest(t.reflected).relative_distance;
                }},
};

struct curve {
    double area = 0;     ///< under the receiver's operating characteristic
    double accepted = 0; ///< share of unknown objects, where 95 % of known ones are
};
curve curve_of(std::vector<double> known, const std::vector<double>& unknown) {
    std::sort(known.begin(), known.end());
    const double largest = known[known.size() - 1 - known.size() / 20];
    curve found;
    for (const double one : unknown) {
        const auto [first, last] = std::equal_range(known.begin(), known.end(), one);
        found.area += static_cast<double>(first - known.begin()) + static_cast<double>(last - first) / 2;
        found.accepted += one <= largest;
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

/// Shares of touches by the logarithm of their squared distance, for a picture.
struct histogram {
    static constexpr double lowest = -2, highest = 4, width = 0.25;
    std::array<sums, static_cast<std::size_t>((highest - lowest) / width)> bins;

    void add(double distance) {
        const double place = (std::log(distance) - lowest) / width;
        const auto bin =
            static_cast<std::size_t>(std::clamp(place, 0.0, static_cast<double>(bins.size() - 1)));
        for (std::size_t b = 0; b < bins.size(); ++b)
            bins[b].add(b == bin ? 100 : 0);
    }
};

/// Trains a network, or takes it from a folder that has it.
model<net> trained(const labelled_images& data, const data_split& split, std::size_t draw, bool thorough,
                   const std::filesystem::path& networks, thread_pool& threads) {
    const std::filesystem::path file =
        networks / ((thorough ? "thorough_" : "default_") + std::to_string(draw) + ".safetensors");
    if (!networks.empty() && std::filesystem::exists(file))
        return load_model<net>(file);
    const recipe settings = recipe::default_for(array.rows, array.columns);
    trainer<net> training(thorough ? settings.thorough() : settings, data, split, draw, threads);
    while (!training.finished())
        (void)training.run_epoch();
    model<net> result = training.trained({});
    for (std::size_t c = 0; c < known_objects; ++c)
        result.classes.push_back("object " + std::to_string(c));
    if (!networks.empty())
        save_model(file, result);
    return result;
}

void run(const std::string& folder, std::size_t draws, bool thorough, const std::filesystem::path& networks) {
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
        const auto network = deploy(trained(data, split, draw, thorough, networks, threads));
        const std::vector<touch> known = touches_of(network, pixels),
                                 all = touches_of(network, images.pixels);

        const fitted single = fit_single_views(known, labels, split.training);
        fitted best = fit_all_views(known, labels, split.training, split.validation);
        // The threshold needs images that nothing was fitted to: each half of the validation images, by a fit
        // to the other one.
        std::vector<double> distances;
        for (const bool second : {false, true}) {
            const fitted other =
                fit_all_views(known, labels, split.training, half_of(split.validation, !second));
            for (const std::size_t i : half_of(split.validation, second))
                distances.push_back(other.nearest(known[i].reflected).relative_distance);
        }
        const double largest = fit_largest_distance(distances, 0.05);

        std::vector<std::size_t> unknown;
        for (std::size_t i = 0; i < images.labels.size(); ++i)
            if (std::find(order.begin(), order.begin() + known_objects, images.labels[i]) ==
                order.begin() + known_objects)
                unknown.push_back(i);
        for (std::size_t s = 0; s < scores.size(); ++s) {
            std::vector<double> of_known, of_unknown;
            for (const std::size_t i : split.test)
                of_known.push_back(scores[s].of(known[i], single, best));
            for (const std::size_t i : unknown)
                of_unknown.push_back(scores[s].of(all[i], single, best));
            const curve found = curve_of(of_known, of_unknown);
            areas[s].add(100 * found.area);
            accepted[s].add(100 * found.accepted);
        }
        for (const std::size_t i : split.test) {
            const nearest_class nearest = best.nearest(known[i].reflected);
            accuracy.add(100.0 * (classify_logits(known[i].alone.logits, known_objects)->index == labels[i]));
            by_means.add(100.0 * (nearest.index == labels[i]));
            alarms.add(100.0 * (nearest.relative_distance > largest));
            of_known_touches.add(nearest.relative_distance);
        }
        for (const std::size_t i : unknown) {
            const double distance = best.nearest(all[i].reflected).relative_distance;
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
                    points[i] = best.point(all[of_object[i]].reflected);
                const auto start = std::chrono::steady_clock::now();
                for (const auto& point : points)
                    (void)best.means.learn(known_objects, point);
                learning.add(
                    std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start)
                        .count());
                for (std::size_t i = 15; i < 35; ++i)
                    (blocked ? blocked_new : random_new)
                        .add(100.0 * (best.nearest(all[of_object[i]].reflected).index == known_objects));
                if (blocked)
                    for (const std::size_t i : split.test)
                        blocked_old.add(100.0 * (best.nearest(known[i].reflected).index == labels[i]));
                best.means.forget(known_objects);
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
    std::printf("\nThe last score, with a threshold for 5 %% of false alarms, by validation images: %.1f %% "
                "of known touches "
                "rejected, %.1f %% "
                "of unknown ones accepted.\n",
                alarms.mean(), unnoticed.mean());
    std::printf("\n| touches | right, %% |\n|---|---|\n");
    std::printf("| of known objects, by the network alone | %.2f |\n", accuracy.mean());
    std::printf("| of known objects, by the nearest mean | %.2f |\n", by_means.mean());
    std::printf("| the same, once a new object is learnt | %.2f |\n", blocked_old.mean());
    std::printf("| of the new object, five touches in a row learnt | %.1f |\n", blocked_new.mean());
    std::printf("| of the new object, five touches in any order learnt | %.1f |\n", random_new.mean());
    std::printf("\nLearning five touches takes %.2f us.\n", learning.mean());
    std::printf("\n| distance / spread, from | known touches, %% | unknown touches, %% "
                "|\n|---|---|---|\n");
    for (std::size_t b = 0; b < of_known_touches.bins.size(); ++b)
        std::printf("| %.2f | %.1f | %.1f |\n",
                    std::exp((histogram::lowest + static_cast<double>(b) * histogram::width) / 2),
                    of_known_touches.bins[b].mean(), of_unknown_touches.bins[b].mean());
}

} // namespace

int main(int count, char** given) {
    const int draws = count > 2 ? std::atoi(given[2]) : 20;
    const bool thorough = count > 3 && std::strcmp(given[3], "thorough") == 0;
    if (count < 2 || count > 5 || draws < 1 ||
        (count > 3 && !thorough && std::strcmp(given[3], "default") != 0)) {
        std::fprintf(stderr,
                     "usage: benchmark_new_objects FOLDER_OF_IMAGES [DRAWS [default|thorough [NETWORKS]]]\n");
        return 2;
    }
    try {
        run(given[1], static_cast<std::size_t>(draws), thorough, count > 4 ? given[4] : "");
    } catch (const std::exception& error) {
        std::fprintf(stderr, "benchmark_new_objects: %s\n", error.what());
        return 2;
    }
}
