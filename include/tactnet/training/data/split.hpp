#pragma once

#include <tactnet/runtime/random.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Shares of each class, by default the paper's 32, 8 and 10 of 50. Remainders of the rounding go to
/// training.
struct split_shares {
    double validation = 8.0 / 50;
    double test = 10.0 / 50;
};

/// The indices of the images for each purpose.
struct data_split {
    std::vector<std::size_t> training, validation, test;
};

/// How samples are divided into sets.
enum class split_rule {
    random, ///< any image may go anywhere
    blocked ///< consecutive images of a class stay together, since neighbours are near-duplicates
};

/// The label of an outlier: an image of no class. A training asks for equal probabilities of all classes for
/// it, so that the network is less sure of unknown objects (outlier exposure: Hendrycks et al., 2019).
inline constexpr std::size_t no_class = std::numeric_limits<std::size_t>::max();

/// Splits each class by the same shares; outliers are for training alone. `labels` are in the order of
/// recording within each class. A blocked split goes around the circle of a class's images from a random
/// start: the test block, the validation block, then training. Every part holds at least one image of each
/// class that has three or more.
[[nodiscard]] inline data_split split_data(std::span<const std::size_t> labels, std::size_t classes,
                                           split_rule rule, std::uint64_t seed, split_shares shares = {}) {
    data_split result;
    for (std::size_t label = 0; label < classes; ++label) {
        std::vector<std::size_t> members;
        for (std::size_t i = 0; i < labels.size(); ++i)
            if (labels[i] == label)
                members.push_back(i);
        if (members.empty())
            continue;
        random_stream random(seed, random_purposes::split, static_cast<std::uint32_t>(label));
        if (rule == split_rule::random) {
            random.shuffle(members);
        } else {
            const auto start = random.below(static_cast<std::uint32_t>(members.size()));
            std::rotate(members.begin(), members.begin() + start, members.end());
        }
        const auto part = [&](double share) {
            const auto n = static_cast<std::size_t>(std::lround(share * static_cast<double>(members.size())));
            return members.size() >= 3 && share > 0 ? std::max<std::size_t>(n, 1) : n;
        };
        const std::size_t kept =
            members.size() >= 3 ? 1 : 0; // whatever the shares, for training and for validation
        const std::size_t room = members.size() - kept;
        const std::size_t test = std::min(part(shares.test), room - (shares.validation > 0 ? kept : 0));
        const std::size_t validation = std::min(part(shares.validation), room - test);
        const auto middle = members.begin() + static_cast<std::ptrdiff_t>(test);
        const auto rest = middle + static_cast<std::ptrdiff_t>(validation);
        result.test.insert(result.test.end(), members.begin(), middle);
        result.validation.insert(result.validation.end(), middle, rest);
        result.training.insert(result.training.end(), rest, members.end());
    }
    for (std::size_t i = 0; i < labels.size(); ++i)
        if (labels[i] == no_class)
            result.training.push_back(i);
    return result;
}

}} // namespace tactnet
