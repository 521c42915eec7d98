#pragma once

#include <tactnet/features/points.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
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

}} // namespace tactnet
