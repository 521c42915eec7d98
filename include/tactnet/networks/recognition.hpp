#pragma once

#include <tactnet/detail/config.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

// What a network's outputs say of a frame. Nothing here uses the heap or throws, and it needs no more than a
// target without files has.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The class that a frame most likely shows.
struct recognition {
    std::size_t index = 0;      ///< of the class
    double probability = 0;     ///< of this class among all that have a name, above 0 and at most 1
    std::string_view name = {}; ///< a view of the caller's name of the class; empty where none was given
};

/// Where the largest value stands, the first of several. NaN is passed over; 0 if there is nothing else.
[[nodiscard]] constexpr std::size_t first_largest(std::span<const float> values) noexcept {
    std::size_t best = values.size();
    for (std::size_t i = 0; i < values.size(); ++i)
        if (best == values.size() ? values[i] == values[i] : values[i] > values[best])
            best = i;
    return best == values.size() ? 0 : best;
}

namespace detail {

/// A recognition by the shares that classes have in a whole. Nothing if there is no class, if a value is not
/// finite, or if all shares are zero.
template <class Share>
[[nodiscard]] std::optional<recognition> recognise_by(std::span<const float> values, Share share) noexcept {
    if (values.empty())
        return std::nullopt;
    const std::size_t best = first_largest(values);
    double sum = 0;
    for (const float value : values) {
        if (!(std::abs(value) <= std::numeric_limits<float>::max()))
            return std::nullopt;
        sum += share(static_cast<double>(value), static_cast<double>(values[best]));
    }
    const double largest = share(static_cast<double>(values[best]), static_cast<double>(values[best]));
    if (!(largest > 0))
        return std::nullopt;
    return recognition{best, largest / sum};
}

/// Gives a recognition among the first outputs its name.
template <class Recognise, class Names>
[[nodiscard]] std::optional<recognition> recognise_named(std::span<const float> outputs, const Names& names,
                                                         Recognise recognise) noexcept {
    if (outputs.size() < names.size())
        return std::nullopt;
    std::optional<recognition> found = recognise(outputs.first(names.size()));
    if (found)
        found->name = names[found->index];
    return found;
}

} // namespace detail

/// The class with the largest logit, of equal ones the first, and its probability by a softmax in double.
/// Nothing if there is no logit, or if one is NaN or infinite: such a network says nothing of its frame.
[[nodiscard]] inline std::optional<recognition> likeliest(std::span<const float> logits) noexcept {
    return detail::recognise_by(logits,
                                [](double logit, double largest) { return std::exp(logit - largest); });
}
/// Names that outlive a call: a container that is not a temporary, or a view.
template <class Names>
concept lasting_names =
    std::is_lvalue_reference_v<Names> || std::ranges::enable_borrowed_range<std::remove_cvref_t<Names>>;

/// With the name of the class: as many logits take part as there are names, which must outlive the result.
/// Nothing if there are fewer logits than names.
template <class Names>
    requires lasting_names<Names>
[[nodiscard]] std::optional<recognition> likeliest(std::span<const float> logits, Names&& names) noexcept {
    return detail::recognise_named(logits, names,
                                   [](std::span<const float> known) { return likeliest(known); });
}

/// The same for a network that ends in a softmax: the class with the largest probability, and its share of
/// what all classes have together. Nothing where that is zero, too.
[[nodiscard]] inline std::optional<recognition> most_probable(std::span<const float> probabilities) noexcept {
    return detail::recognise_by(probabilities, [](double probability, double) { return probability; });
}
/// The same with the class's name.
template <class Names>
    requires lasting_names<Names>
[[nodiscard]] std::optional<recognition> most_probable(std::span<const float> probabilities,
                                                       Names&& names) noexcept {
    return detail::recognise_named(probabilities, names,
                                   [](std::span<const float> known) { return most_probable(known); });
}

} // namespace TACTNET_ARCH
} // namespace tactnet
