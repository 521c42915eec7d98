#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/training/data/labelled_samples.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// What the nearest images to those of a test say of it. Two images are *related* if they are of one group
/// or, without groups, one after the other in the order of recording of their class. If the nearest image of
/// the same class is related more often than by chance, then images of a group are near-duplicates, and a
/// test that has related images in training is easier than new groups will be.
struct neighbour_report {
    /// An image and the nearest of its class.
    struct pair {
        std::size_t image, nearest;
        double distance; ///< root mean square of the differences, in counts
    };
    std::vector<pair> related;  ///< whose nearest image is related, the nearest first
    std::size_t tested = 0;     ///< images that have others of their class to be compared with
    double expected = 0;        ///< as many related pairs would be found by chance
    double recognised = 0;      ///< share of the test that has the class of the nearest image of any class
    double without_related = 0; ///< the same where related images may not be the nearest

    /// Whether the number of related pairs is more than chance allows: twice as many, by five deviations.
    [[nodiscard]] bool too_easy() const {
        const auto found = static_cast<double>(related.size()), n = static_cast<double>(tested);
        return found > 2 * expected && found - expected > 5 * std::sqrt(expected * (1 - expected / n));
    }
};

namespace detail {

/// Of independent sums, for vectors.
inline constexpr std::size_t distance_lanes = 16;

/// Square roots of pressures, which are the means of at most 16 x 16 blocks of an image, filled up with zeros
/// to whole vectors.
inline std::vector<float> blurred(std::span<const std::uint8_t> pixels, shape size, std::size_t& numbers) {
    const std::size_t high = ceil_div(size.rows, std::size_t{16}),
                      wide = ceil_div(size.columns, std::size_t{16});
    const std::size_t rows = ceil_div(size.rows, high), columns = ceil_div(size.columns, wide);
    numbers = ceil_div(rows * columns, distance_lanes) * distance_lanes;
    std::vector<float> all(pixels.size() / size.size() * numbers);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        const std::size_t tactel = i % size.size() / size.channels;
        all[i / size.size() * numbers + tactel / size.columns / high * columns +
            tactel % size.columns / wide] += static_cast<float>(pixels[i]);
    }
    for (float& sum : all)
        sum = std::sqrt(sum / static_cast<float>(high * wide));
    return all;
}

} // namespace detail

/// Looks for the nearest among the `others` of each tested image; the same image is no neighbour of itself,
/// so that both may be all images. `size` is that of an image, `groups` has the group of each image or is
/// empty: then images are related if one follows the other in its class, and `without_related` leaves out a
/// tenth of each class before and after the same place, as another person or session would. Images of no
/// class are left out. Takes the number of tested times other images, times 256 multiply-adds at most.
[[nodiscard]] inline neighbour_report compare_neighbours(const labelled_images& images, shape size,
                                                         std::span<const std::size_t> groups,
                                                         std::span<const std::size_t> tested,
                                                         std::span<const std::size_t> others) {
    std::size_t numbers = 0;
    const std::vector<float> all = detail::blurred(images.pixels, size, numbers);
    std::vector<std::size_t> place(images.labels.size()), members(images.classes);
    for (std::size_t i = 0; i < place.size(); ++i)
        if (images.labels[i] < images.classes)
            place[i] = members[images.labels[i]]++;
    const auto distance_of = [&](std::size_t a, std::size_t b) {
        std::array<float, detail::distance_lanes> sums{};
        for (std::size_t e = 0; e < numbers; e += sums.size())
            for (std::size_t lane = 0; lane < sums.size(); ++lane) {
                const float d = all[a * numbers + e + lane] - all[b * numbers + e + lane];
                sums[lane] += d * d;
            }
        return std::accumulate(sums.begin(), sums.end(), 0.0F);
    };
    const auto apart = [&](std::size_t a, std::size_t b) {
        return place[a] > place[b] ? place[a] - place[b] : place[b] - place[a];
    };
    const auto relative = [&](std::size_t image) {
        return static_cast<double>(place[image]) / static_cast<double>(members[images.labels[image]]);
    };
    struct nearest {
        std::size_t image = 0;
        float distance = std::numeric_limits<float>::infinity();
        void take(std::size_t other, float to) {
            if (to < distance)
                image = other, distance = to;
        }
    };
    neighbour_report report;
    double compared = 0;
    for (const std::size_t image : tested) {
        const std::size_t label = images.labels[image];
        if (label >= images.classes)
            continue;
        nearest of_all, of_class, unrelated;
        std::size_t in_class = 0, related_in_class = 0;
        for (const std::size_t other : others) {
            if (other == image || images.labels[other] >= images.classes)
                continue;
            const bool same = images.labels[other] == label;
            const bool related =
                !groups.empty() ? groups[other] == groups[image] : same && apart(image, other) <= 1;
            const float distance = distance_of(image, other);
            of_all.take(other, distance);
            if (!groups.empty() ? !related : std::abs(relative(image) - relative(other)) > 0.1)
                unrelated.take(other, distance);
            if (!same)
                continue;
            of_class.take(other, distance);
            ++in_class;
            related_in_class += related;
        }
        if (in_class == 0)
            continue;
        ++report.tested;
        report.expected += static_cast<double>(related_in_class) / static_cast<double>(in_class);
        report.recognised += images.labels[of_all.image] == label;
        if (std::isfinite(unrelated.distance)) {
            ++compared;
            report.without_related += images.labels[unrelated.image] == label;
        }
        if (!groups.empty() ? groups[of_class.image] == groups[image] : apart(image, of_class.image) <= 1)
            report.related.push_back({image, of_class.image, 0});
    }
    report.recognised /= static_cast<double>(std::max<std::size_t>(report.tested, 1));
    report.without_related /= std::max(compared, 1.0);
    for (neighbour_report::pair& p : report.related) {
        double sum = 0;
        for (std::size_t e = 0; e < size.size(); ++e) {
            const double d = static_cast<double>(images.pixels[p.image * size.size() + e]) -
                             static_cast<double>(images.pixels[p.nearest * size.size() + e]);
            sum += d * d;
        }
        p.distance = std::sqrt(sum / static_cast<double>(size.size()));
    }
    std::sort(report.related.begin(), report.related.end(), [](const auto& a, const auto& b) {
        return std::pair(a.distance, a.image) < std::pair(b.distance, b.image);
    });
    return report;
}

}} // namespace tactnet
