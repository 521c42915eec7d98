#pragma once

#include <tactnet/tensor/tensor.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string_view>
#include <type_traits>

// From the outputs of a network to the class that they name, and the reflections of an image over which
// outputs may be averaged. Nothing here uses the heap or throws, and it needs no more than a target without
// files has.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The class that a frame most likely shows.
struct recognition {
    std::size_t index = 0;      ///< of the class
    double probability = 0;     ///< of this class among all that have a name, above 0 and at most 1
    std::string_view name = {}; ///< a view of the caller's name of the class; empty where none was given
};

/// The index of the largest value; ties go to the first. Skips NaN; 0 if there is no other value.
[[nodiscard]] constexpr std::size_t first_largest(std::span<const float> values) noexcept {
    std::size_t best = values.size();
    for (std::size_t i = 0; i < values.size(); ++i)
        if (best == values.size() ? values[i] == values[i] : values[i] > values[best])
            best = i;
    return best == values.size() ? 0 : best;
}

namespace detail {

/// The class with the largest of the first `classes` outputs, and its share of the sum of all shares.
template <class Share>
[[nodiscard]] std::optional<recognition> classify_by(std::span<const float> outputs, std::size_t classes,
                                                     Share share) noexcept {
    if (classes == 0 || classes > outputs.size())
        return std::nullopt;
    const std::span<const float> values = outputs.first(classes);
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

/// Names a class, if there is one.
template <class Names>
[[nodiscard]] std::optional<recognition> with_name(std::optional<recognition> found,
                                                   const Names& names) noexcept {
    if (found)
        found->name = names[found->index];
    return found;
}

} // namespace detail

/// Names of classes that outlive a call: a container that is not a temporary, or a view.
template <class Names>
concept borrowed_names = borrowed_range<Names> && requires(const std::remove_reference_t<Names>& names) {
    std::string_view(names[names.size()]);
};

/// Whether logits may be divided by it: from 0.001 to 1000, beyond which probabilities are equal or certain.
[[nodiscard]] constexpr bool is_temperature(double temperature) noexcept {
    return temperature >= 1e-3 && temperature <= 1e3;
}

/// The class with the largest of the first `classes` logits (ties go to the first), and its probability by a
/// softmax in double of logits ÷ temperature. A network may have more outputs than classes; further outputs
/// are unused. std::nullopt if there is no class, if there are fewer logits than classes, if one of them is
/// NaN or infinite, or if the temperature is none (is_temperature).
[[nodiscard]] inline std::optional<recognition>
classify_logits(std::span<const float> logits, std::size_t classes, double temperature = 1) noexcept {
    if (!is_temperature(temperature))
        return std::nullopt;
    return detail::classify_by(logits, classes, [=](double logit, double largest) {
        return std::exp((logit - largest) / temperature);
    });
}
/// As many classes as names, which must outlive the result.
template <borrowed_names Names>
[[nodiscard]] std::optional<recognition> classify_logits(std::span<const float> logits,
                                                         Names&& names) noexcept {
    return detail::with_name(classify_logits(logits, names.size()), names);
}

/// The class with the largest of the first `classes` probabilities, as of a network that ends in a softmax,
/// and its share of their sum; at a temperature other than 1, of their powers by 1 ÷ temperature, as if it
/// divided the logits before the softmax. std::nullopt as classify_logits, and if all are zero.
[[nodiscard]] inline std::optional<recognition> classify_probabilities(std::span<const float> probabilities,
                                                                       std::size_t classes,
                                                                       double temperature = 1) noexcept {
    if (!is_temperature(temperature))
        return std::nullopt;
    return detail::classify_by(probabilities, classes, [=](double probability, double largest) {
        return temperature == 1 ? probability : std::pow(probability / largest, 1 / temperature);
    });
}
/// As many classes as names, which must outlive the result.
template <borrowed_names Names>
[[nodiscard]] std::optional<recognition> classify_probabilities(std::span<const float> probabilities,
                                                                Names&& names) noexcept {
    return detail::with_name(classify_probabilities(probabilities, names.size()), names);
}

/// A reflection of an image: flipped vertically, horizontally, both (a rotation by 180°) or not at all.
struct reflection {
    bool rows = false, columns = false;

    /// Whether it reflects along no other axes.
    [[nodiscard]] constexpr bool within(reflection axes) const noexcept {
        return (!rows || axes.rows) && (!columns || axes.columns);
    }
};

/// The reflections of a touch: the object is the same in all of them.
inline constexpr std::array<reflection, 4> all_reflections{
    {{false, false}, {true, false}, {false, true}, {true, true}}};

/// Writes the reflected image to `to`, which must not overlap `from`.
template <class Count>
constexpr void reflect_image(const shape& image, reflection how, const Count* from, Count* to) {
    for (std::size_t channel = 0; channel < image.channels; ++channel)
        for (std::size_t row = 0; row < image.rows; ++row, to += image.columns) {
            const Count* const line =
                from + (channel * image.rows + (how.rows ? image.rows - 1 - row : row)) * image.columns;
            for (std::size_t column = 0; column < image.columns; ++column)
                to[column] = line[how.columns ? image.columns - 1 - column : column];
        }
}

/// The mean of one output over an image and its reflections, in the order of all_reflections. Added in pairs,
/// so that each of the four images gives the same bits.
[[nodiscard]] constexpr float mean_of_reflections(float upright, float rows, float columns, float both) {
    return ((upright + rows) + (columns + both)) / 4;
}
/// Returns the mean over reflections along the given axes alone; at(r) is an output for all_reflections[r].
template <class At>
[[nodiscard]] constexpr float mean_of_reflections(reflection axes, const At& at) {
    if (axes.rows && axes.columns)
        return mean_of_reflections(at(0), at(1), at(2), at(3));
    return axes.rows || axes.columns ? (at(0) + at(axes.rows ? 1 : 2)) / 2 : at(0);
}

/// Which reflections of an image show a class, and which class: for most touches the same one. Where left and
/// right differ, the reflected image of a class shows its partner. `Partners` holds indices of classes, or
/// refers to them.
template <class Partners>
struct basic_reflection_rule {
    /// What one axis allows.
    struct axis {
        bool reflects = false; ///< whether reflected images show one of the classes at all
        Partners partners{};   ///< of each class; empty if each is its own

        /// The class that the reflected image of a class shows. What is no class stays so.
        [[nodiscard]] constexpr std::size_t partner(std::size_t label) const {
            return label < partners.size() ? partners[label] : label;
        }
        friend bool operator==(const axis&, const axis&) = default;
    };
    axis rows{}, columns{};

    /// Each class is its own partner in all reflections.
    [[nodiscard]] static constexpr basic_reflection_rule all() { return {{true, {}}, {true, {}}}; }
    [[nodiscard]] constexpr reflection axes() const { return {rows.reflects, columns.reflects}; }
    /// The class that the reflected image of a class shows.
    [[nodiscard]] constexpr std::size_t partner(reflection how, std::size_t label) const {
        const std::size_t upright = how.rows ? rows.partner(label) : label;
        return how.columns ? columns.partner(upright) : upright;
    }
    /// Writes the mean of outputs over the images that it allows. `outputs_of(r)` is a row of outputs for
    /// all_reflections[r], of a network with `to.size()` outputs.
    template <class OutputsOf>
    constexpr void average(const OutputsOf& outputs_of, std::span<float> to) const {
        for (std::size_t e = 0; e < to.size(); ++e)
            to[e] = mean_of_reflections(axes(), [&](std::size_t r) -> float {
                return outputs_of(r)[partner(all_reflections[r], e)];
            });
    }
    friend bool operator==(const basic_reflection_rule&, const basic_reflection_rule&) = default;
};
/// A rule whose partners are kept elsewhere.
using reflection_rule_view = basic_reflection_rule<std::span<const std::size_t>>;

}} // namespace tactnet
