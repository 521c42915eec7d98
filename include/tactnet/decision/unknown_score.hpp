#pragma once

#include <tactnet/decision/discriminant.hpp>
#include <tactnet/decision/exponentials.hpp>

#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <span>

// Scores from the literature that separate known from unknown objects, with one interface.
// docs/recognise/decision.md compares them.

namespace tactnet { inline namespace TACTNET_ARCH {

/// How unlike the objects of the training a touch is, by the logits of a network, one for each class, and the
/// features that its last layer reads. The larger, the less known; infinity for logits or features that are
/// not finite.
template <class Score>
concept unknown_score =
    requires(const Score& score, std::span<const float> logits, std::span<const float> features) {
        { score(logits, features) } noexcept -> std::same_as<double>;
    };

/// The largest softmax output, as its negative logarithm (Hendrycks and Gimpel, 2017).
struct softmax_score {
    [[nodiscard]] double operator()(std::span<const float> logits, std::span<const float>) const noexcept {
        const detail::value_range range(logits);
        return range.finite ? std::log(detail::sum_of_exponentials(logits, range.largest, 1))
                            : std::numeric_limits<double>::infinity();
    }
};

/// The free energy (Liu et al., 2020).
struct energy_score {
    [[nodiscard]] double operator()(std::span<const float> logits, std::span<const float>) const noexcept {
        const detail::value_range range(logits);
        return range.finite ? -static_cast<double>(range.largest) -
                                  std::log(detail::sum_of_exponentials(logits, range.largest, 1))
                            : std::numeric_limits<double>::infinity();
    }
};

/// The largest logit divided by the norm of the features: how well their direction fits a class.
struct direction_score {
    [[nodiscard]] double operator()(std::span<const float> logits,
                                    std::span<const float> features) const noexcept {
        const detail::value_range range(logits);
        double squares = 0;
        for (const float value : features)
            squares += static_cast<double>(value) * static_cast<double>(value);
        const double score = -static_cast<double>(range.largest) / std::sqrt(squares);
        return range.finite && std::isfinite(score) ? score : std::numeric_limits<double>::infinity();
    }
};

/// The distance to the nearest class mean in the dimensions of a discriminant, relative to the spread of the
/// class (after Lee et al., 2018). The best single score on the paper's images. Discriminant and means must
/// outlive the score.
template <std::size_t Features, std::size_t Dimensions, std::size_t MostClasses>
class distance_score {
public:
    distance_score(const discriminant<Features, Dimensions>& map,
                   const class_means<Dimensions, MostClasses>& means) noexcept
        : map_(&map), means_(&means) {}

    /// Takes Features features.
    [[nodiscard]] double operator()(std::span<const float>, std::span<const float> features) const noexcept {
        const auto nearest = means_->nearest(map_->project(features.template first<Features>()));
        return nearest ? nearest->relative_distance : std::numeric_limits<double>::infinity();
    }

private:
    const discriminant<Features, Dimensions>* map_;
    const class_means<Dimensions, MostClasses>* means_;
};

/// The product of two scores that are not negative: large if both are unsure of a touch. A distance_score in
/// a discriminant's dimensions times one in those of fit_whitening, which also sees dimensions in which no
/// two classes differ, is the best of all on the paper's images.
template <unknown_score First, unknown_score Second>
struct product_score {
    First first;
    Second second;

    [[nodiscard]] double operator()(std::span<const float> logits,
                                    std::span<const float> features) const noexcept {
        const double product = first(logits, features) * second(logits, features);
        return std::isnan(product) ? std::numeric_limits<double>::infinity() : product; // 0 times infinity
    }
};
/// Takes the types from its scores.
template <class First, class Second>
product_score(First, Second) -> product_score<First, Second>; // which Clang 14 does not find by itself

/// Takes touches whose score is above a limit for those of unknown objects.
template <unknown_score Score>
struct unknown_detector {
    Score score;
    double largest; ///< of a known object: see fit_largest_distance

    [[nodiscard]] bool is_unknown(std::span<const float> logits,
                                  std::span<const float> features) const noexcept {
        return !(score(logits, features) <= largest);
    }
};

}} // namespace tactnet
