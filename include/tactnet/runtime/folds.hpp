#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

// Folds of a cross-validation: for each sample the fold that holds it out, from 0. All are scikit-learn's.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The place of each value among all different values in rising order.
[[nodiscard]] inline std::vector<std::size_t> ranks_of(std::span<const std::size_t> values) {
    std::vector<std::size_t> different(values.begin(), values.end()), ranks;
    std::sort(different.begin(), different.end());
    different.erase(std::unique(different.begin(), different.end()), different.end());
    for (const std::size_t value : values)
        ranks.push_back(static_cast<std::size_t>(std::lower_bound(different.begin(), different.end(), value) -
                                                 different.begin()));
    return ranks;
}
[[nodiscard]] inline std::size_t count_of(std::span<const std::size_t> ranks) {
    return ranks.empty() ? 0 : *std::max_element(ranks.begin(), ranks.end()) + 1;
}
inline void require_folds(std::size_t folds, std::size_t most, const char* of) {
    if (folds < 2 || folds > most)
        throw std::invalid_argument("folds: expected 2 to " + std::to_string(most) + ", the number of " + of +
                                    ", found " + std::to_string(folds));
}

} // namespace detail

/// Folds with equal shares of each class, samples of a class in their order: `StratifiedKFold`. Throws
/// std::invalid_argument for fewer than two folds, or more than samples.
[[nodiscard]] inline std::vector<std::size_t> stratified_folds(std::span<const std::size_t> labels,
                                                               std::size_t folds) {
    detail::require_folds(folds, labels.size(), "samples");
    std::vector<std::size_t> first, classes, sorted; // classes by their first sample
    for (const std::size_t label : labels) {
        const auto known = std::find(first.begin(), first.end(), label);
        classes.push_back(static_cast<std::size_t>(known - first.begin()));
        if (known == first.end())
            first.push_back(label);
    }
    sorted = classes;
    std::sort(sorted.begin(), sorted.end());
    // left[c][f]: samples of class c that fold f still gets
    std::vector<std::vector<std::size_t>> left(first.size(), std::vector<std::size_t>(folds));
    for (std::size_t i = 0; i < sorted.size(); ++i)
        ++left[sorted[i]][i % folds];
    std::vector<std::size_t> fold_of, next(first.size());
    for (const std::size_t c : classes) {
        while (left[c][next[c]] == 0)
            ++next[c];
        --left[c][next[c]];
        fold_of.push_back(next[c]);
    }
    return fold_of;
}

/// Folds of whole groups, of about equally many samples: the largest group that is left goes to the smallest
/// fold, of groups of one size the one with the highest number first: `GroupKFold`. Where more than 16 groups
/// have one size, which of them comes first depends on the version of NumPy there. Throws
/// std::invalid_argument for fewer than two folds, or more than groups.
[[nodiscard]] inline std::vector<std::size_t> group_folds(std::span<const std::size_t> groups,
                                                          std::size_t folds) {
    std::vector<std::size_t> fold_of = detail::ranks_of(groups);
    std::vector<std::size_t> size(detail::count_of(fold_of)), order(size.size()), fold_of_group(size.size());
    detail::require_folds(folds, size.size(), "groups");
    for (const std::size_t group : fold_of)
        ++size[group];
    std::iota(order.begin(), order.end(), std::size_t{0});
    // Not std::stable_sort: newer compilers warn in that of GCC 12.
    std::sort(order.begin(), order.end(),
              [&](std::size_t a, std::size_t b) { return std::pair(size[a], a) > std::pair(size[b], b); });
    std::vector<std::size_t> weight(folds);
    for (const std::size_t group : order) {
        const auto lightest = std::min_element(weight.begin(), weight.end());
        *lightest += size[group];
        fold_of_group[group] = static_cast<std::size_t>(lightest - weight.begin());
    }
    for (std::size_t& group : fold_of)
        group = fold_of_group[group];
    return fold_of;
}

/// A fold for each group, by rising number: `LeaveOneGroupOut`. Throws std::invalid_argument for fewer than
/// two groups.
[[nodiscard]] inline std::vector<std::size_t> one_group_folds(std::span<const std::size_t> groups) {
    std::vector<std::size_t> fold_of = detail::ranks_of(groups);
    if (detail::count_of(fold_of) < 2)
        throw std::invalid_argument("folds: expected two groups or more, found " +
                                    std::to_string(detail::count_of(fold_of)));
    return fold_of;
}

}} // namespace tactnet
