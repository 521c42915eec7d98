#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/features/points.hpp>
#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

// k-means clustering: Lloyd's algorithm ("Least squares quantization in PCM", 1982) with k-means++ seeds
// (Arthur and Vassilvitskii, 2007).

namespace tactnet { inline namespace TACTNET_ARCH {

namespace random_purposes {
inline constexpr random_purpose clusters{5}; ///< seeds of clusters
} // namespace random_purposes

/// Settings of k-means.
struct k_means_settings {
    std::size_t centres = 500;
    std::size_t max_iterations = 100;
    /// Stops when an iteration lowers the objective by no more than this fraction.
    double least_gain = 1e-4;
    std::uint64_t seed = 1;
};

/// The result of k-means.
struct k_means_result {
    aligned_vector<float> centres;      ///< contiguous
    std::vector<std::uint32_t> nearest; ///< the centre of each point
    double objective = 0;               ///< sum of squared distances of the points to their centres
    std::size_t iterations = 0;
    bool converged = false;
};

namespace detail {

/// Copies rows to another length. Padding with zeros changes no distance.
inline aligned_vector<float> rows_of_length(std::size_t length, std::span<const float> rows,
                                            std::size_t before) {
    const std::size_t count = rows.size() / before;
    aligned_vector<float> result(count * length);
    for (std::size_t i = 0; i < count; ++i)
        std::copy_n(rows.data() + i * before, std::min(length, before), result.data() + i * length);
    return result;
}

/// k-means on aligned points padded to whole vectors.
template <std::size_t Values>
class k_means_run {
public:
    k_means_run(std::span<const float> points, const k_means_settings& settings, thread_pool& threads)
        : points_(points),
          count_(points.size() / Values),
          settings_(settings),
          threads_(threads),
          distances_(count_, std::numeric_limits<double>::infinity()),
          block_sums_(detail::ceil_div(count_, block)) {}

    /// The seeds of k-means++.
    [[nodiscard]] aligned_vector<float> seeds() && {
        seed();
        return std::move(result_.centres);
    }
    /// Runs Lloyd's algorithm from these centres.
    [[nodiscard]] k_means_result improve(aligned_vector<float> centres) && {
        result_.centres = std::move(centres);
        result_.nearest.resize(count_);
        origin_ = far_origin<Values>(points_);
        result_.objective = assign();
        while (!result_.converged && result_.iterations < settings_.max_iterations) {
            const double last = result_.objective;
            move_centres();
            result_.objective = assign();
            ++result_.iterations;
            result_.converged = last - result_.objective <= settings_.least_gain * last;
        }
        return std::move(result_);
    }

private:
    // Points whose distances one thread adds up, fixed so that sums do not depend on the number of threads.
    static constexpr std::size_t block = 1024;

    [[nodiscard]] const float* point(std::size_t i) const { return points_.data() + i * Values; }
    /// The squared distance of point i and centre c.
    [[nodiscard]] double distance(std::size_t i, std::size_t c) const {
        return kernels::squared_distance<Values>(point(i), result_.centres.data() + c * Values);
    }
    /// Sets distances_[i] = term(i) for all points in parallel, and returns their sum.
    template <class Term>
    double measure(const Term& term) {
        threads_.for_each(block_sums_.size(), [&](std::size_t b) {
            double sum = 0;
            for (std::size_t i = b * block; i < std::min((b + 1) * block, count_); ++i)
                sum += distances_[i] = term(i);
            block_sums_[b] = sum;
        });
        return std::accumulate(block_sums_.begin(), block_sums_.end(), 0.0);
    }
    void add_centre(std::size_t i) {
        result_.centres.insert(result_.centres.end(), point(i), point(i) + Values);
    }
    /// Draws each seed with a probability proportional to the squared distance to the nearest seed so far.
    void seed() {
        random_stream random(settings_.seed, random_purposes::clusters);
        add_centre(random.below(static_cast<std::uint32_t>(count_)));
        for (std::size_t c = 1; c < std::min(settings_.centres, count_); ++c) {
            const double sum =
                measure([&](std::size_t i) { return std::min(distances_[i], distance(i, c - 1)); });
            if (sum == 0)
                return; // every point is a seed already
            add_centre(draw_by_distance(random.uniform() * sum));
        }
    }
    /// The point at `rest` in the cumulative sum of distances.
    [[nodiscard]] std::size_t draw_by_distance(double rest) const {
        std::size_t b = 0;
        while (b + 1 < block_sums_.size() && rest >= block_sums_[b])
            rest -= block_sums_[b++];
        std::size_t chosen = b * block;
        for (std::size_t i = b * block; i < std::min((b + 1) * block, count_); ++i) {
            if (distances_[i] > 0)
                chosen = i;
            if (rest < distances_[i])
                break;
            rest -= distances_[i];
        }
        // If rounding leaves a rest after the last point, takes the last point that is no seed yet.
        while (!(distances_[chosen] > 0))
            --chosen;
        return chosen;
    }
    /// Finds the nearest centre of every point. Returns the objective.
    double assign() {
        const nearest_point<Values> search(result_.centres, origin_);
        threads_.for_each(block_sums_.size(), [&](std::size_t b) {
            const std::size_t first = b * block, count = std::min(block, count_ - first);
            search.find(points_.subspan(first * Values, count * Values), result_.nearest.data() + first);
        });
        return measure([&](std::size_t i) { return distance(i, result_.nearest[i]); });
    }
    /// Moves every centre to the mean of its points.
    void move_centres() {
        const std::size_t centres = result_.centres.size() / Values;
        std::vector<std::size_t> ends(centres + 1), order(count_);
        for (const std::uint32_t c : result_.nearest)
            ++ends[c + 1];
        std::partial_sum(ends.begin(), ends.end(), ends.begin());
        std::vector<std::size_t> next(ends.begin(), ends.end() - 1);
        for (std::size_t i = 0; i < count_; ++i)
            order[next[result_.nearest[i]]++] = i;
        threads_.for_each(centres, [&](std::size_t c) {
            if (ends[c] == ends[c + 1])
                return;
            std::array<double, Values> sums{};
            for (std::size_t i = ends[c]; i < ends[c + 1]; ++i)
                for (std::size_t v = 0; v < Values; ++v)
                    sums[v] += static_cast<double>(point(order[i])[v]);
            for (std::size_t v = 0; v < Values; ++v)
                result_.centres[c * Values + v] =
                    static_cast<float>(sums[v] / static_cast<double>(ends[c + 1] - ends[c]));
        });
        fill_empty(ends);
    }
    /// Moves each centre without points to the point that is farthest from its own centre.
    void fill_empty(const std::vector<std::size_t>& ends) {
        for (std::size_t c = 0; c + 1 < ends.size(); ++c)
            if (ends[c] == ends[c + 1]) {
                const auto farthest = std::max_element(distances_.begin(), distances_.end());
                const auto i = static_cast<std::size_t>(farthest - distances_.begin());
                *farthest = 0;
                std::copy_n(point(i), Values, result_.centres.data() + c * Values);
            }
    }

    std::span<const float> points_;
    std::size_t count_;
    const k_means_settings& settings_;
    thread_pool& threads_;
    std::vector<double> distances_, block_sums_;
    std::vector<double> origin_; ///< the mean that the search subtracts, or empty
    k_means_result result_;
};

} // namespace detail

/// Draws k-means++ seeds for `settings.centres` clusters of contiguous `points` of `Values` numbers. Returns
/// fewer if there are fewer different points. Throws std::invalid_argument as k_means does.
template <std::size_t Values>
[[nodiscard]] aligned_vector<float> k_means_seeds(std::span<const float> points,
                                                  const k_means_settings& settings, thread_pool& threads) {
    detail::check_points("k_means", points, Values);
    if (settings.centres == 0)
        throw std::invalid_argument("k_means: expected at least one centre, found 0");
    constexpr std::size_t whole = kernels::padded_size<float>(Values);
    const aligned_vector<float> padded = detail::rows_of_length(whole, points, Values);
    const aligned_vector<float> seeds = detail::k_means_run<whole>(padded, settings, threads).seeds();
    return detail::rows_of_length(Values, seeds, whole);
}

/// Runs Lloyd's algorithm from any number of centres. Throws std::invalid_argument as k_means does.
template <std::size_t Values>
[[nodiscard]] k_means_result k_means_from(std::span<const float> points, std::span<const float> centres,
                                          const k_means_settings& settings, thread_pool& threads) {
    detail::check_points("k_means", points, Values);
    detail::check_points("k_means: centres", centres, Values);
    constexpr std::size_t whole = kernels::padded_size<float>(Values);
    const aligned_vector<float> padded = detail::rows_of_length(whole, points, Values);
    k_means_result result = detail::k_means_run<whole>(padded, settings, threads)
                                .improve(detail::rows_of_length(whole, centres, Values));
    result.centres = detail::rows_of_length(Values, result.centres, whole);
    return result;
}

/// Clusters contiguous `points` of `Values` numbers. Bit-identical on any number of threads. Returns fewer
/// centres than asked for if there are fewer different points. Throws std::invalid_argument if there are no
/// points or centres, or if a number is NaN, infinite or beyond 10¹⁷.
template <std::size_t Values>
[[nodiscard]] k_means_result k_means(std::span<const float> points, const k_means_settings& settings,
                                     thread_pool& threads) {
    return k_means_from<Values>(points, k_means_seeds<Values>(points, settings, threads), settings, threads);
}

}} // namespace tactnet
