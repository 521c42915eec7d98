#pragma once

#include <tactnet/runtime/random.hpp>
#include <tactnet/training/data/labelled_samples.hpp>
#include <tactnet/training/data/split.hpp>
#include <tactnet/training/evaluate.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <utility>
#include <vector>

// What judges the short trainings of a search: samples that they do not learn, and a score for each class of
// each group of them.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// Divides samples into those that short trainings learn and those that judge them: whole groups, or blocks
/// of each class in the order of recording. A class stays in training.
inline data_split hold_out(const labelled_samples& samples, std::span<const std::size_t> chosen,
                           std::span<const std::size_t> groups, std::uint64_t seed) {
    constexpr double share = 0.25;
    data_split split;
    std::vector<std::size_t> labels(samples.size(), no_class);
    for (const std::size_t i : chosen)
        labels[i] = samples.label(i);
    std::set<std::size_t> held;
    if (!groups.empty()) {
        std::map<std::size_t, std::set<std::size_t>> classes_of;
        std::vector<std::size_t> groups_with(samples.classes()), order;
        for (const std::size_t i : chosen)
            if (labels[i] != no_class && classes_of[groups[i]].insert(labels[i]).second)
                ++groups_with[labels[i]];
        for (const auto& [group, classes] : classes_of)
            order.push_back(group);
        random_stream(seed, random_purposes::split, stream_of_held_out).shuffle(order);
        const auto most = static_cast<std::size_t>(std::lround(share * static_cast<double>(order.size())));
        for (const std::size_t group : order) {
            const auto& classes = classes_of[group];
            if (held.size() < std::max<std::size_t>(most, 1) &&
                std::all_of(classes.begin(), classes.end(),
                            [&](std::size_t c) { return groups_with[c] > 1; })) {
                held.insert(group);
                for (const std::size_t c : classes)
                    --groups_with[c];
            }
        }
    }
    if (held.empty()) {
        split = split_data(labels, samples.classes(), split_rule::blocked, seed,
                           {.validation = 0, .test = share});
        std::swap(split.validation, split.test);
        const std::set<std::size_t> wanted(chosen.begin(), chosen.end());
        std::erase_if(split.training, [&](std::size_t i) { return !wanted.contains(i); });
        return split;
    }
    for (const std::size_t i : chosen)
        (held.contains(groups[i]) && labels[i] != no_class ? split.validation : split.training).push_back(i);
    return split;
}

inline constexpr std::size_t fewest_scores = 4; ///< whose standard error says anything

/// The mean probability of the right class for each class of each group, in order: of its parts if there are
/// few, so that four samples or more have `fewest_scores`.
inline std::vector<double> scores_of(const evaluation& found, const labelled_samples& samples,
                                     std::span<const std::size_t> judged,
                                     std::span<const std::size_t> groups) {
    const std::size_t classes = samples.classes();
    const auto unit = [&](std::size_t i) {
        return std::pair(groups.empty() ? 0 : groups[i], samples.label(i));
    };
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> sizes, before;
    for (const std::size_t i : judged)
        ++sizes[unit(i)];
    const std::size_t parts = sizes.size() < fewest_scores ? fewest_scores : 1;
    std::map<std::pair<std::pair<std::size_t, std::size_t>, std::size_t>, std::pair<double, double>> sums;
    for (std::size_t i = 0; i < judged.size(); ++i) {
        const auto logits = std::span(found.logits).subspan(i * classes, classes);
        const std::size_t label = samples.label(judged[i]);
        double sum = 0;
        for (const float logit : logits)
            sum += std::exp(static_cast<double>(logit - logits[label]));
        const auto of = unit(judged[i]);
        auto& [total, count] = sums[{of, before[of]++ * parts / sizes[of]}];
        total += 1 / sum, ++count;
    }
    std::vector<double> scores;
    for (const auto& [of, sum] : sums)
        scores.push_back(sum.first / sum.second);
    return scores;
}

}}} // namespace tactnet::detail
