#pragma once

#include <tactnet/lowering/input_function.hpp>
#include <tactnet/networks/reflection_rule.hpp>
#include <tactnet/training/data/labelled_samples.hpp>

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Throws std::invalid_argument for samples of another shape or class than they say, for a chosen one that
/// does not exist, and for groups that are not one for each sample.
inline void check_chosen(shape image, const labelled_samples& samples, std::span<const std::size_t> chosen,
                         std::span<const std::size_t> groups) {
    samples.check(image, samples.classes());
    samples.check_indices(chosen);
    if (!groups.empty() && groups.size() != samples.size())
        throw_invalid_argument(
            {"images: expected the group of each of ", samples.size(), ", found ", groups.size()});
}

/// The groups, or none if each class of the chosen samples has one: there is no other to compare it with.
inline std::span<const std::size_t> groups_to_compare(const labelled_samples& samples,
                                                      std::span<const std::size_t> chosen,
                                                      std::span<const std::size_t> groups) {
    std::map<std::size_t, std::size_t> group_of; // by class
    if (!groups.empty())
        for (const std::size_t i : chosen)
            if (samples.label(i) < samples.classes() &&
                group_of.try_emplace(samples.label(i), groups[i]).first->second != groups[i])
                return groups;
    return {};
}

/// Mean images of each class in each group, compressed so that neither gain nor a few large counts matter.
/// Without groups, parts of a class in the order of recording take their place.
class class_images {
public:
    class_images(shape image, const labelled_samples& samples, std::span<const std::size_t> chosen,
                 std::span<const std::size_t> groups)
        : image_(image), classes_(samples.classes()) {
        constexpr std::size_t parts = 4;
        std::vector<std::size_t> of_class(classes_), before(classes_);
        for (const std::size_t i : chosen)
            if (samples.label(i) < classes_)
                ++of_class[samples.label(i)];
        std::vector<float> compressed(image.size());
        for (const std::size_t i : chosen) {
            const std::size_t label = samples.label(i);
            if (label >= classes_)
                continue;
            const std::size_t group = groups.empty() ? before[label]++ * parts / of_class[label] : groups[i];
            samples.copy(i, compressed);
            input_function{count_rule::relative_logarithm}.apply(compressed);
            summed& sum = sums_[{label, group}];
            sum.pixels.resize(image.size());
            for (std::size_t e = 0; e < compressed.size(); ++e)
                sum.pixels[e] += static_cast<double>(compressed[e]);
            ++sum.images;
        }
    }

    /// Pairs of classes whose reflected images resemble each other more than themselves, by a tenth of the
    /// squared distance and in three of four groups, compared with the other groups: the clearest pair first.
    /// Empty unless one of the pairs is clear.
    [[nodiscard]] std::vector<std::size_t> partners(reflection how) const {
        struct pair {
            double gain;
            std::size_t a, b;
        };
        std::map<std::size_t, std::vector<double>> of_groups; // by group: distances [class][class]
        for (const auto& [key, of_group] : sums_)
            of_groups.try_emplace(key.second, distances(how, key.second));
        // Without a pair that is nearest to each other in most groups, distances are those of chance.
        std::vector<std::size_t> votes(classes_ * classes_);
        for (const auto& [group, d] : of_groups)
            for (std::size_t a = 0; a < classes_; ++a) {
                const auto row = d.begin() + static_cast<std::ptrdiff_t>(a * classes_);
                const auto nearest = std::min_element(row, row + static_cast<std::ptrdiff_t>(classes_));
                if (*nearest < missing)
                    votes[a * classes_ + static_cast<std::size_t>(nearest - row)] += 2;
            }
        bool clear = false;
        std::vector<pair> pairs;
        for (std::size_t a = 0; a < classes_; ++a)
            for (std::size_t b = a + 1; b < classes_; ++b) {
                double own = 0, other = 0;
                std::size_t groups = 0, nearer = 0;
                clear =
                    clear || std::min(votes[a * classes_ + b], votes[b * classes_ + a]) > of_groups.size();
                for (const auto& [group, d] : of_groups) {
                    const double alone = d[a * classes_ + a] + d[b * classes_ + b],
                                 exchanged = d[a * classes_ + b] + d[b * classes_ + a];
                    if (!(alone + exchanged < missing))
                        continue;
                    own += alone, other += exchanged;
                    ++groups, nearer += exchanged < alone ? 1 : 0;
                }
                if (4 * nearer >= 3 * groups && other < 0.9 * own)
                    pairs.push_back({own - other, a, b});
            }
        std::sort(pairs.begin(), pairs.end(), [](const pair& x, const pair& y) { return x.gain > y.gain; });
        std::vector<std::size_t> found(clear && !pairs.empty() ? classes_ : 0);
        std::iota(found.begin(), found.end(), std::size_t{0});
        for (const pair& p : pairs)
            if (!found.empty() && found[p.a] == p.a && found[p.b] == p.b)
                found[p.a] = p.b, found[p.b] = p.a;
        return found;
    }

    /// The mean squared distance of reflected images to those of the class that they should show, divided by
    /// that of the images as they are to their own class: little more than 1 if a touch may come either way
    /// round.
    [[nodiscard]] double strangeness(reflection how, const reflection_rule& rule) const {
        std::set<std::size_t> groups;
        for (const auto& [key, of_group] : sums_)
            groups.insert(key.second);
        double reflected = 0, upright = 0;
        for (const std::size_t group : groups) {
            const std::vector<double> shown = distances(how, group), own = distances({}, group);
            for (std::size_t c = 0; c < classes_; ++c)
                if (const double d = shown[c * classes_ + rule.partner(how, c)]; d < missing)
                    if (const double o = own[c * classes_ + c]; o < missing)
                        reflected += d, upright += o;
        }
        return upright > 0 ? reflected / upright : 1;
    }

private:
    struct summed {
        std::vector<double> pixels{};
        std::size_t images = 0;
    };
    static constexpr double missing = 1e300; ///< distance to a class that no other group has

    /// Squared distances from the reflected mean images of a group to those of all others.
    [[nodiscard]] std::vector<double> distances(reflection how, std::size_t group) const {
        std::vector<summed> others(classes_);
        for (const auto& [key, of_group] : sums_)
            if (key.second != group) {
                summed& mean = others[key.first];
                mean.pixels.resize(image_.size());
                mean.images += of_group.images;
                for (std::size_t e = 0; e < image_.size(); ++e)
                    mean.pixels[e] += of_group.pixels[e];
            }
        std::vector<double> result(classes_ * classes_, missing), reflected(image_.size());
        for (std::size_t a = 0; a < classes_; ++a) {
            const auto own = sums_.find({a, group});
            if (own == sums_.end())
                continue;
            reflect_image(image_, how, own->second.pixels.data(), reflected.data());
            for (std::size_t b = 0; b < classes_; ++b) {
                if (others[b].images == 0)
                    continue;
                double sum = 0;
                for (std::size_t e = 0; e < reflected.size(); ++e) {
                    const double difference = reflected[e] / static_cast<double>(own->second.images) -
                                              others[b].pixels[e] / static_cast<double>(others[b].images);
                    sum += difference * difference;
                }
                result[a * classes_ + b] = sum;
            }
        }
        return result;
    }

    shape image_;
    std::size_t classes_;
    std::map<std::pair<std::size_t, std::size_t>, summed> sums_; ///< by (class, group)
};

} // namespace detail

/// What reflected images of the chosen samples show, by mean images: along each axis the class itself, unless
/// they are strangers to it (strangeness above 2); then the partner, as left and right are; or nothing, if
/// they resemble no class (strangeness above 2.4). With fewer than 8 samples a class all stays reflected.
/// `groups` are those of all samples (people, objects, sessions), or none; if each class has one, parts of a
/// class take their place. Throws std::invalid_argument unless there is an image, a class and, if any, a
/// group for each sample, and each chosen one is there.
[[nodiscard]] inline reflection_rule find_reflections(shape image, const labelled_samples& samples,
                                                      std::span<const std::size_t> chosen,
                                                      std::span<const std::size_t> groups = {}) {
    // The paper's images have 1.6 at most, lying people 2.4 or more, and 2.7 upside down with partners.
    constexpr double strange = 2, too_strange = 2.4;
    detail::check_chosen(image, samples, chosen, groups);
    const detail::class_images means(image, samples, chosen,
                                     detail::groups_to_compare(samples, chosen, groups));
    reflection_rule rule = reflection_rule::all();
    constexpr std::size_t fewest = 8; // of a class: means of fewer are single touches
    if (chosen.size() < fewest * samples.classes())
        return rule;
    for (const auto& [axis, how] : {std::pair(&rule.rows, reflection{.rows = true}),
                                    std::pair(&rule.columns, reflection{.columns = true})}) {
        if (means.strangeness(how, rule) <= strange)
            continue;
        axis->partners = means.partners(how);
        if (means.strangeness(how, rule) > too_strange)
            *axis = {};
    }
    return rule;
}

}} // namespace tactnet
