#pragma once

#include <tactnet/runtime/folds.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
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

/// How samples are divided into sets. A group is what must not be on both sides: a person, an object, a
/// session, a sensor.
enum class split_rule {
    random,           ///< any image may go anywhere
    blocked,          ///< consecutive images of a class stay together, since neighbours are near-duplicates
    grouped,          ///< whole groups, drawn at random, by about the shares
    stratified_folds, ///< the test is one of k folds with equal shares of each class
    group_folds,      ///< the test is one of k folds of whole groups
    leave_one_group_out, ///< the test is one group
    given                ///< the caller's own: `split_data` refuses it
};

/// Whether the test is one of a fixed number of folds, of which seed s names number s modulo that.
[[nodiscard]] constexpr bool has_folds(split_rule rule) {
    return rule == split_rule::stratified_folds || rule == split_rule::group_folds ||
           rule == split_rule::leave_one_group_out;
}
/// Whether a rule needs groups.
[[nodiscard]] constexpr bool needs_groups(split_rule rule) {
    return rule == split_rule::grouped || rule == split_rule::group_folds ||
           rule == split_rule::leave_one_group_out;
}

/// The label of an outlier: an image of no class. A training asks for equal probabilities of all classes for
/// it, so that the network is less sure of unknown objects (outlier exposure: Hendrycks et al., 2019).
inline constexpr std::size_t no_class = std::numeric_limits<std::size_t>::max();

/// Splits each class by the same shares; outliers are for training alone. `labels` are in the order of
/// recording within each class. A blocked split goes around the circle of a class's images from a random
/// start: the test block, the validation block, then training. Every part holds at least one image of each
/// class that has three or more. Throws std::invalid_argument for a rule that needs groups or folds.
[[nodiscard]] inline data_split split_data(std::span<const std::size_t> labels, std::size_t classes,
                                           split_rule rule, std::uint64_t seed, split_shares shares = {}) {
    if (rule != split_rule::random && rule != split_rule::blocked)
        detail::throw_invalid_argument(
            {"split_data: expected the rule random or blocked, or the group of each sample, found neither"});
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
            std::rotate(members.begin(), members.begin() + static_cast<std::ptrdiff_t>(start), members.end());
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

namespace detail {

/// Streams of draws from the training part, other than those that made it: 0 and 1 of groups, 0 … of classes.
inline constexpr std::uint32_t stream_of_kept = 0x60, stream_of_held_out = 0x61;

/// Moves whole groups out of training, in random order, as long as that brings the classes closer to their
/// share or brings in a class that the part lacks. No class loses its last group: training needs each.
/// `part_of` each sample: 0 is training, `part` the one that grows.
inline void move_groups(std::span<const std::size_t> labels, std::span<const std::size_t> groups,
                        std::vector<char>& part_of, char part, double share, random_stream random) {
    std::map<std::size_t, std::map<std::size_t, double>> counts; // of a group's samples by class
    std::map<std::size_t, double> wanted, left;                  // by class: samples; groups in training
    for (std::size_t i = 0; i < labels.size(); ++i) {
        wanted[labels[i]] += share;
        if (part_of[i] == 0)
            ++counts[groups[i]][labels[i]];
    }
    std::vector<std::size_t> order;
    for (const auto& [group, classes] : counts) {
        order.push_back(group);
        for (const auto& of_class : classes)
            ++left[of_class.first];
    }
    random.shuffle(order);
    std::map<std::size_t, bool> moved;
    std::map<std::size_t, double> in_part;
    for (const std::size_t group : order) {
        double closer = 0;
        bool may = share > 0, lacking = false;
        for (const auto& [label, count] : counts[group]) {
            may = may && left[label] > 1;
            lacking = lacking || in_part[label] == 0;
            const double missing = wanted[label] - in_part[label];
            closer += std::abs(missing) - std::abs(missing - count);
        }
        if (!may || !(lacking || closer > 0))
            continue;
        moved[group] = true;
        for (const auto& [label, count] : counts[group])
            in_part[label] += count, --left[label];
    }
    for (std::size_t i = 0; i < labels.size(); ++i)
        if (part_of[i] == 0 && moved[groups[i]])
            part_of[i] = part;
}

} // namespace detail

/// Splits by any rule but `given`. `groups` has the group of each sample; rules that need none ignore it. Of
/// a rule with folds, the test is fold `seed` modulo their number, whatever `shares.test` is. Groups for
/// validation are drawn from the rest. A draw by shares leaves each class a group for training, so that a
/// class of one group is not tested; a fold does not. Throws std::invalid_argument where groups are missing
/// or too few.
[[nodiscard]] inline data_split split_data(std::span<const std::size_t> labels, std::size_t classes,
                                           std::span<const std::size_t> groups, split_rule rule,
                                           std::uint64_t seed, split_shares shares = {},
                                           std::size_t folds = 5) {
    if (rule == split_rule::random || rule == split_rule::blocked || rule == split_rule::given)
        return split_data(labels, classes, rule, seed, shares);
    if (needs_groups(rule) && groups.size() != labels.size())
        detail::throw_invalid_argument({"split_data: expected the group of each of ", labels.size(),
                                        " samples, found ", groups.size(), " groups"});
    std::vector<std::size_t> samples, of_class, of_group; // without outliers
    for (std::size_t i = 0; i < labels.size(); ++i)
        if (labels[i] < classes) {
            samples.push_back(i);
            of_class.push_back(labels[i]);
            of_group.push_back(needs_groups(rule) ? groups[i] : i);
        }
    std::vector<char> part_of(samples.size());
    const auto stream = [&](std::uint32_t part) { return random_stream(seed, random_purposes::split, part); };
    if (has_folds(rule)) {
        const std::vector<std::size_t> fold_of =
            rule == split_rule::stratified_folds ? stratified_folds(of_class, folds)
            : rule == split_rule::group_folds    ? group_folds(of_group, folds)
                                                 : one_group_folds(of_group);
        const std::size_t held = static_cast<std::size_t>(seed % detail::count_of(fold_of));
        for (std::size_t i = 0; i < samples.size(); ++i)
            part_of[i] = fold_of[i] == held ? 2 : 0;
    } else {
        detail::move_groups(of_class, of_group, part_of, 2, shares.test, stream(0));
    }
    detail::move_groups(of_class, of_group, part_of, 1, shares.validation, stream(1));
    data_split result;
    for (std::size_t i = 0; i < samples.size(); ++i)
        (part_of[i] == 0   ? result.training
         : part_of[i] == 1 ? result.validation
                           : result.test)
            .push_back(samples[i]);
    for (std::size_t i = 0; i < labels.size(); ++i)
        if (labels[i] >= classes)
            result.training.push_back(i);
    return result;
}

/// The names of the parts of a split, in the order of its members.
inline constexpr const char* split_parts[] = {"training", "validation", "test"};

/// What is wrong with a split: a sample or a group in two parts, or a sample to validate or to test whose
/// class training lacks.
struct split_problem {
    enum { overlap, shared_group, lacking_class } kind;
    std::size_t sample, part, other_part; ///< parts by their places in `split_parts`; a class lacks in part 0
};

/// The first problem of a split whose samples are all below the number of labels, or nothing. Samples may be
/// repeated within training. `groups` may be empty.
[[nodiscard]] inline std::optional<split_problem> problem_of(const data_split& split,
                                                             std::span<const std::size_t> labels,
                                                             std::span<const std::size_t> groups = {}) {
    const std::vector<std::size_t>* const parts[] = {&split.training, &split.validation, &split.test};
    std::map<std::size_t, std::size_t> sample_in, group_in;
    std::set<std::size_t> learnt;
    for (std::size_t part = 0; part < 3; ++part)
        for (const std::size_t sample : *parts[part]) {
            if (const std::size_t other = sample_in.try_emplace(sample, part).first->second; other != part)
                return split_problem{split_problem::overlap, sample, part, other};
            if (!groups.empty())
                if (const std::size_t other = group_in.try_emplace(groups[sample], part).first->second;
                    other != part)
                    return split_problem{split_problem::shared_group, sample, part, other};
            if (part == 0)
                learnt.insert(labels[sample]);
            else if (!learnt.contains(labels[sample]))
                return split_problem{split_problem::lacking_class, sample, part, 0};
        }
    return std::nullopt;
}

/// Throws std::invalid_argument for a problem of a split, and for samples that there are not.
inline void check_split(const data_split& split, std::span<const std::size_t> labels,
                        std::span<const std::size_t> groups = {}) {
    for (const auto* part : {&split.training, &split.validation, &split.test})
        for (const std::size_t sample : *part)
            if (sample >= labels.size())
                detail::throw_invalid_argument(
                    {"split: expected samples below ", labels.size(), ", found ", sample});
    const auto problem = problem_of(split, labels, groups);
    if (!problem)
        return;
    const auto& [kind, sample, part, other] = *problem;
    if (kind == split_problem::lacking_class)
        detail::throw_invalid_argument({"split: expected training samples of class ", labels[sample],
                                        ", of which sample ", sample, " is in ", split_parts[part],
                                        ", found none"});
    detail::throw_invalid_argument({"split: expected ", kind == split_problem::overlap ? "sample " : "group ",
                                    kind == split_problem::overlap ? sample : groups[sample],
                                    " in one part, found it in ", split_parts[other], " and in ",
                                    split_parts[part]});
}

/// Keeps a share of the training samples of each class, drawn at random, for a curve of accuracy against
/// their number. `groups` may be empty; otherwise whole groups are kept until no class has less than its
/// share. Validation and test stay as they are. A smaller share of single samples is part of a larger one.
[[nodiscard]] inline data_split part_of_training(data_split split, std::span<const std::size_t> labels,
                                                 std::span<const std::size_t> groups, double share,
                                                 std::uint64_t seed) {
    std::map<std::size_t, double> missing;                   // samples, by class
    std::map<std::size_t, std::vector<std::size_t>> members; // by group
    for (const std::size_t sample : split.training) {
        ++missing[labels[sample]];
        members[groups.empty() ? sample : groups[sample]].push_back(sample);
    }
    std::vector<std::size_t> order;
    for (const auto& of_group : members)
        order.push_back(of_group.first);
    random_stream(seed, random_purposes::split, detail::stream_of_kept).shuffle(order);
    for (auto& of_class : missing)
        of_class.second = std::ceil(share * of_class.second - 1e-9); // 0.28 of 25 are 7
    split.training.clear();
    for (const std::size_t group : order)
        if (const auto& of_group = members[group]; std::any_of(
                of_group.begin(), of_group.end(), [&](std::size_t i) { return missing[labels[i]] > 0; }))
            for (const std::size_t sample : of_group) {
                --missing[labels[sample]];
                split.training.push_back(sample);
            }
    std::sort(split.training.begin(), split.training.end());
    return split;
}

/// Repeats training samples of rare classes in turn, until each class has as many as the largest: for classes
/// of 5 and of 100 images. Each repetition is augmented by itself. Outliers stay as they are.
[[nodiscard]] inline data_split balanced(data_split split, std::span<const std::size_t> labels) {
    std::map<std::size_t, std::vector<std::size_t>> members;
    std::size_t most = 0;
    for (const std::size_t sample : split.training)
        if (labels[sample] != no_class)
            members[labels[sample]].push_back(sample);
    for (const auto& of_class : members)
        most = std::max(most, of_class.second.size());
    for (const auto& of_class : members)
        for (std::size_t i = of_class.second.size(); i < most; ++i)
            split.training.push_back(of_class.second[i % of_class.second.size()]);
    return split;
}

}} // namespace tactnet
