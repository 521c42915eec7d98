#include "evaluation/decisions.hpp"

#include <tactnet/decision/fitting.hpp>
#include <tactnet/decision/sensor_health.hpp>
#include <tactnet/decision/unknown_score.hpp>
#include <tactnet/runtime/random.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace {

constexpr auto faulty_tactels = tactnet::random_purpose::named("tactnet/faulty_tactels");

std::vector<std::size_t> labels_of(const image_data& data, std::span<const std::size_t> images) {
    std::vector<std::size_t> labels;
    for (const std::size_t image : images)
        labels.push_back(data.images.labels[image]);
    return labels;
}

/// Each image as five frames of air and five of the touch, of which it returns the last, corrected.
template <tactnet::shape Array>
std::vector<std::uint8_t> corrected(std::span<const std::uint8_t> images, const std::vector<bool>& stuck) {
    const auto health = std::make_unique<tactnet::sensor_health<Array>>();
    std::array<std::uint8_t, Array.size()> air{}, touch{};
    for (int i = 0; i < 50; ++i)
        health->learn(air);
    std::vector<std::uint8_t> all;
    for (std::size_t first = 0; first < images.size(); first += Array.size()) {
        for (std::size_t i = 0; i < Array.size(); ++i) {
            touch[i] = images[first + i];
            if (stuck[i])
                air[i] = touch[i] = 255;
        }
        for (int i = 0; i < 5; ++i) {
            (void)health->clean(air);
            health->follow(air);
        }
        for (int i = 0; i < 4; ++i)
            (void)health->clean(touch);
        const auto clean = health->clean(touch);
        all.insert(all.end(), clean.begin(), clean.end());
    }
    return all;
}
template <tactnet::shape... Arrays>
std::vector<std::uint8_t> corrected_at(std::size_t rows, std::size_t columns,
                                       std::span<const std::uint8_t> images, const std::vector<bool>& stuck) {
    std::vector<std::uint8_t> found;
    ((Arrays.rows == rows && Arrays.columns == columns ? void(found = corrected<Arrays>(images, stuck))
                                                       : void()),
     ...);
    return found;
}

/// The area under the receiver operating characteristic, and the share of unknown ones accepted where 95 %
/// of known ones are.
std::pair<double, double> curve_of(std::vector<double> known, std::vector<double> unknown) {
    std::ranges::sort(known);
    std::ranges::sort(unknown);
    double pairs = 0;
    for (const double score : unknown) {
        const auto [first, last] = std::ranges::equal_range(known, score);
        pairs += static_cast<double>(first - known.begin()) + 0.5 * static_cast<double>(last - first);
    }
    const auto limit = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(known.size()))) - 1;
    const auto accepted = std::ranges::upper_bound(unknown, known[limit]) - unknown.begin();
    const auto count = static_cast<double>(unknown.size());
    return {pairs / count / static_cast<double>(known.size()), static_cast<double>(accepted) / count};
}

} // namespace

std::string text_of(const decision_means& means, const decision_column& column) {
    const auto found = means.find(std::string(column.name));
    if (found == means.end())
        return {};
    return column.is_share ? fmt::format("{:.2f}", 100 * found->second.value())
                           : fmt::format("{:.3f}", found->second.value());
}

void add_means(decision_means& to, const decision_means& from) {
    for (const auto& [name, mean] : from) {
        to[name].sum += mean.sum;
        to[name].count += mean.count;
    }
}

decision_means sets_of_classes(const tactnet::evaluation& validation, const tactnet::evaluation& test,
                               const image_data& data, const tactnet::data_split& split) {
    if (validation.logits.empty() || test.logits.empty() || !std::isfinite(validation.loss))
        return {};
    const std::size_t classes = data.images.classes.size();
    const auto labels = labels_of(data, split.validation);
    const auto set =
        tactnet::fit_prediction_set(tactnet::fit_temperature(validation.logits, classes, labels, classes),
                                    0.95, validation.logits, classes, labels, classes);
    decision_mean coverage, size;
    const auto members = std::make_unique<bool[]>(classes);
    for (std::size_t i = 0; i < split.test.size(); ++i) {
        size.sum += static_cast<double>(
            set.predict(std::span(test.logits).subspan(i * classes, classes), {members.get(), classes}));
        coverage.sum += members[data.images.labels[split.test[i]]];
    }
    coverage.count = size.count = static_cast<double>(split.test.size());
    return {{"set_coverage", coverage}, {"set_size", size}};
}

decision_means faults_of_sensor(const trained_method& trained, const image_data& data,
                                std::span<const std::size_t> images, std::uint64_t seed,
                                tactnet::thread_pool& threads) {
    const std::size_t rows = data.images.rows, columns = data.images.columns, size = rows * columns;
    std::vector<bool> row(size), tactels(size);
    tactnet::random_stream random(seed, faulty_tactels);
    const std::size_t broken = random.below(static_cast<std::uint32_t>(rows));
    for (std::size_t i = 0; i < size; ++i) {
        row[i] = i / columns == broken;
        tactels[i] = random.uniform() < 0.05;
    }
    const auto labels = labels_of(data, images);
    std::vector<std::size_t> chosen(images.size());
    std::iota(chosen.begin(), chosen.end(), 0U);
    decision_means means;
    for (const auto& [name, stuck] : {std::pair{"stuck_row", &row}, std::pair{"stuck_tactels", &tactels}}) {
        std::vector<std::uint8_t> raw;
        for (const std::size_t image : images)
            for (std::size_t i = 0; i < size; ++i)
                raw.push_back((*stuck)[i] ? std::uint8_t{255} : data.images.pixels[image * size + i]);
        using tactnet::shape;
        const auto clean =
            corrected_at<shape{28, 50}, shape{20, 35}, shape{14, 25}, shape{10, 18}, shape{7, 13}>(
                rows, columns, raw, *stuck);
        if (clean.size() != raw.size())
            return {};
        const auto add = [&](const std::string& to, const std::vector<std::uint8_t>& pixels) {
            const tactnet::labelled_images view{pixels, labels, data.images.classes.size()};
            const auto confusion = trained.evaluate(view, chosen, threads).confusion;
            means[to] = {static_cast<double>(confusion.correct()), static_cast<double>(confusion.total())};
        };
        add(std::string(name) + "_accuracy", raw);
        add(std::string(name) + "_corrected_accuracy", clean);
    }
    return means;
}

image_data images_of_classes(const image_data& all, std::span<const std::size_t> classes) {
    image_data some;
    some.images.rows = all.images.rows, some.images.columns = all.images.columns;
    some.taken.size = all.taken.size;
    const auto copy = [&](const std::vector<std::uint8_t>& from, std::size_t image, std::size_t size,
                          std::vector<std::uint8_t>& to) {
        const auto first = from.begin() + static_cast<std::ptrdiff_t>(image * size);
        to.insert(to.end(), first, first + static_cast<std::ptrdiff_t>(size));
    };
    for (std::size_t c = 0; c < classes.size(); ++c) {
        some.images.classes.push_back(all.images.classes[classes[c]]);
        for (std::size_t i = 0; i < all.images.labels.size(); ++i) {
            if (all.images.labels[i] != classes[c])
                continue;
            some.images.labels.push_back(c);
            copy(all.images.pixels, i, all.images.rows * all.images.columns, some.images.pixels);
            if (!all.taken.pixels.empty())
                copy(all.taken.pixels, i, all.taken.size.size(), some.taken.pixels);
        }
    }
    return some;
}

class_choice choose_classes(std::size_t classes, std::size_t unknown, std::uint64_t seed) {
    class_choice choice;
    const std::size_t first = seed % classes * unknown % classes;
    for (std::size_t c = 0; c < classes; ++c)
        ((c + classes - first) % classes < unknown ? choice.unknown : choice.known).push_back(c);
    return choice;
}

decision_means separation(const tactnet::evaluation& of_known, const tactnet::evaluation& of_unknown,
                          std::size_t classes) {
    decision_means means;
    const auto add = [&](const std::string& name, const auto& score) {
        const auto scores = [&](std::span<const float> logits) {
            std::vector<double> all;
            for (; !logits.empty(); logits = logits.subspan(classes))
                all.push_back(score(logits.first(classes), {}));
            return all;
        };
        const auto [area, accepted] = curve_of(scores(of_known.logits), scores(of_unknown.logits));
        means["unknown_" + name + "_area"] = {area, 1};
        means["unknown_" + name + "_accepted"] = {accepted, 1};
    };
    if (!of_known.logits.empty() && !of_unknown.logits.empty()) {
        add("softmax", tactnet::softmax_score{});
        add("energy", tactnet::energy_score{});
    }
    return means;
}
