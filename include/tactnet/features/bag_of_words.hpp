#pragma once

#include <tactnet/features/dense_surf.hpp>
#include <tactnet/features/k_means.hpp>
#include <tactnet/features/points.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

// Bags of visual words (Csurka, Dance, Fan, Willamowski and Bray, "Visual categorization with bags of
// keypoints", 2004): each descriptor is assigned to the nearest word, and an image is the histogram of its
// words.

namespace tactnet { inline namespace TACTNET_ARCH {

/// How counts of words are scaled to features of unit length.
enum class histogram_form {
    counts,      ///< divided by their Euclidean length
    square_roots ///< square roots, divided by their Euclidean length: products are the Hellinger kernel
                 ///< (Arandjelović and Zisserman, "Three things everyone should know to improve object
                 ///< retrieval", 2012)
};

/// A vocabulary of up to `Words` words of `Values` numbers. Bins of missing words stay 0. Safe to share
/// between threads.
template <std::size_t Values, std::size_t Words>
class bag_of_words {
    static_assert(Values > 0 && Words > 0, "bag_of_words: expected at least one value a word, and one word");

public:
    using histogram = std::span<float, Words>;

    /// Takes contiguous words, as k_means returns them. Throws std::invalid_argument if there are none or
    /// more than `Words`, or if a number is not finite.
    explicit bag_of_words(std::span<const float> words, histogram_form form = histogram_form::counts)
        : words_(words.begin(), words.end()), search_(words, detail::far_origin<Values>(words)), form_(form) {
        detail::check_points("bag_of_words", words, Values);
        if (count() > Words)
            detail::throw_invalid_argument(
                {"bag_of_words: expected at most ", Words, " words, found ", count()});
    }

    /// Number of words.
    [[nodiscard]] std::size_t count() const noexcept { return words_.size() / Values; }
    [[nodiscard]] std::span<const float> words() const& noexcept { return words_; }
    void words() const&& = delete; // would dangle
    [[nodiscard]] histogram_form form() const noexcept { return form_; }

    /// Computes the histogram of contiguous descriptors without heap use. It has unit length, or is 0 if
    /// there are no descriptors.
    void encode(std::span<const float> descriptors, histogram out) const noexcept {
        std::fill(out.begin(), out.end(), 0.0f);
        std::array<std::uint32_t, at_once> nearest;
        const std::size_t descriptor_count = descriptors.size() / Values;
        for (std::size_t first = 0; first < descriptor_count; first += nearest.size()) {
            const std::size_t n = std::min(nearest.size(), descriptor_count - first);
            search_.find(descriptors.subspan(first * Values, n * Values), nearest.data());
            for (std::size_t i = 0; i < n; ++i)
                ++out[nearest[i]];
        }
        if (descriptor_count > 0)
            normalise(out);
    }

private:
    static constexpr std::size_t at_once = 4 * kernels::nearest_row<Values>::group;

    void normalise(histogram counts) const noexcept {
        double squares = 0;
        for (float& n : counts) {
            if (form_ == histogram_form::square_roots)
                n = std::sqrt(n);
            squares += static_cast<double>(n) * static_cast<double>(n);
        }
        const auto factor = static_cast<float>(1 / std::sqrt(squares));
        for (float& n : counts)
            n *= factor;
    }

    std::vector<float> words_;
    detail::nearest_point<Values> search_;
    histogram_form form_;
};

// Histograms of SURF words of pressure images, the features of the paper's baseline: a 3 × 3 grid step,
// k-means, 500 words, and a linear support vector machine.

/// Settings that the paper leaves open. Words, step and scales are template arguments: 500, 3 × 3 tactels, 1
/// and 2. Chosen by the mean accuracy on the validation images of 20 random splits, 28 × 50 tactels: 91 %.
/// Counts instead of square roots (which are not the paper's) give 89 %, scale 1 or 2 alone 86 or 88 %, and
/// scales 1 to 3 90 %; a step of 2 gives 92 % and takes twice the time. Spatial pyramids gained nothing on 5
/// of the splits.
struct surf_settings {
    /// Descriptors to find the words from, equally many per image.
    std::size_t max_descriptors = 20'000;
    /// Iterations of k-means.
    std::size_t max_iterations = 15;
    std::uint64_t seed = 1;
    histogram_form form = histogram_form::square_roots;
    /// C of the linear support vector machine (squared hinge, one against the rest).
    double cost = 10;
};

namespace detail {

/// Calls body(surf, i) with the descriptors of image chosen[i] for every i in parallel. Throws
/// std::invalid_argument if an image does not exist, or has NaN or infinity.
template <class Surf, class Body>
void describe_images(std::span<const typename Surf::pixel_type> images, std::span<const std::size_t> chosen,
                     thread_pool& threads, const Body& body) {
    const std::size_t count = images.size() / Surf::extents.size();
    for (const std::size_t image : chosen)
        if (image >= count)
            detail::throw_invalid_argument({"dense SURF: there is no image ", image, " among ", count});
    std::vector<Surf> memories(threads.threads());
    std::vector<std::size_t> broken(threads.threads(), count); // the first one of each thread
    threads.on_each_thread([&](thread_pool::share part) {
        Surf& surf = memories[part.index];
        for (std::size_t i = part.begin(chosen.size()); i < part.end(chosen.size()); ++i) {
            const auto* pixels = images.data() + chosen[i] * Surf::extents.size();
            if (surf.describe(typename Surf::image_view(pixels)))
                body(surf, i);
            else
                broken[part.index] = std::min(broken[part.index], chosen[i]);
        }
    });
    const std::size_t first = *std::min_element(broken.begin(), broken.end());
    if (first < count)
        detail::throw_invalid_argument({"dense SURF: expected finite pixels, found NaN or infinity in image ",
                                        first, " (counted from 0)"});
}

/// Appends up to `share` random descriptors to `points`.
template <class Surf>
void draw_descriptors(const Surf& surf, std::size_t share, random_stream random, std::vector<float>& points) {
    std::array<std::size_t, Surf::most> order{};
    const std::size_t count = surf.places().size();
    std::iota(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count), std::size_t{0});
    for (std::size_t d = 0; d < std::min(share, count); ++d) {
        std::swap(order[d], order[d + random.below(static_cast<std::uint32_t>(count - d))]);
        const std::span<const float> chosen = surf.descriptors().subspan(order[d] * surf_values, surf_values);
        points.insert(points.end(), chosen.begin(), chosen.end());
    }
}

} // namespace detail

/// Finds the words of the `chosen` ones of contiguous images, which should be those of the training set.
/// Bit-identical on any number of threads. Throws std::invalid_argument if a pixel is not finite, or if no
/// image has contact.
template <class Surf, std::size_t Words = 500>
[[nodiscard]] bag_of_words<surf_values, Words>
fit_surf_words(std::span<const typename Surf::pixel_type> images, std::span<const std::size_t> chosen,
               const surf_settings& settings, thread_pool& threads) {
    const std::size_t share = settings.max_descriptors / std::max<std::size_t>(chosen.size(), 1) + 1;
    std::vector<std::vector<float>> drawn(chosen.size());
    for (std::vector<float>& of_image : drawn)
        of_image.reserve(std::min(share, Surf::most) * surf_values); // no heap use in the threads
    detail::describe_images<Surf>(images, chosen, threads, [&](const Surf& surf, std::size_t i) {
        // Major 1: k_means draws from 0.
        const random_stream random(settings.seed, random_purposes::clusters, 1,
                                   static_cast<std::uint32_t>(i));
        detail::draw_descriptors(surf, share, random, drawn[i]);
    });
    std::vector<float> points;
    for (const std::vector<float>& of_image : drawn)
        points.insert(points.end(), of_image.begin(), of_image.end());
    if (points.empty())
        detail::throw_invalid_argument(
            {"dense SURF: found nothing to describe in ", chosen.size(), " images: all of them are zero"});
    const k_means_result found = k_means<surf_values>(
        points, {.centres = Words, .max_iterations = settings.max_iterations, .seed = settings.seed},
        threads);
    return bag_of_words<surf_values, Words>(found.centres, settings.form);
}

/// Computes the histogram of one image without heap use. If the image has NaN or infinity, returns false and
/// a histogram of zeros.
template <class Surf, std::size_t Words>
[[nodiscard]] bool surf_histogram(Surf& surf, const bag_of_words<surf_values, Words>& words,
                                  typename Surf::image_view image,
                                  std::span<float, Words> histogram) noexcept {
    const bool finite = surf.describe(image);
    words.encode(surf.descriptors(), histogram);
    return finite;
}

/// Computes the contiguous histograms of the chosen images. Throws std::invalid_argument if a pixel is not
/// finite.
template <class Surf, std::size_t Words>
[[nodiscard]] aligned_vector<float>
surf_histograms(std::span<const typename Surf::pixel_type> images, std::span<const std::size_t> chosen,
                const bag_of_words<surf_values, Words>& words, thread_pool& threads) {
    aligned_vector<float> histograms(chosen.size() * Words);
    detail::describe_images<Surf>(images, chosen, threads, [&](const Surf& surf, std::size_t i) {
        words.encode(surf.descriptors(), std::span<float, Words>(histograms.data() + i * Words, Words));
    });
    return histograms;
}

}} // namespace tactnet
