#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/tensor/named_array.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// The layout of the folded numbers of a network in 8 bits: named arrays, for checks and files, which need not
// know the network's type. deployment/eight_bit.hpp makes the layout of a network's type.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The arrays of one step.
struct folded_step {
    /// A named array.
    struct array : named_array {
        folded_kind kind; ///< the meaning of its numbers
    };
    std::string name;          ///< its path in the network: "step2", "step3.main.step1"
    double largest_input = 0;  ///< the largest magnitude of an input of a step with weights
    std::vector<array> arrays; ///< in the order of the folded numbers
    bool adds = false;         ///< of a step without weights: whether it adds two maps, or multiplies them

    /// The array of this name in `arrays` of the step, or null.
    [[nodiscard]] const array* find(std::string_view array_name) const {
        for (const array& a : arrays)
            if (std::string_view(a.name).substr(name.size() + 1) == array_name)
                return &a;
        return nullptr;
    }
};
/// The layout of all folded numbers, in their order.
struct folded_layout {
    shape input;
    std::size_t outputs = 0;
    std::size_t steps_folded = 0;   ///< numbers before those of the steps: the frame's
    std::size_t numbers = 0;        ///< how many there are
    bool ends_in_weights = false;   ///< whether the last step has a filter for each output
    std::vector<folded_step> steps; ///< those with folded numbers
};

namespace detail {

// For the templates of deployment/eight_bit.hpp; not inlined, to save compile time.

/// Appends a step with these arrays.
[[gnu::cold, gnu::noinline]] inline void append_step(folded_layout& to, const std::string& name,
                                                     const folded_arrays& arrays, double largest_input,
                                                     bool adds = false) {
    folded_step step{name, largest_input, {}, adds};
    for (std::size_t i = 0; i < arrays.count; ++i) {
        const folded_array& says = arrays.list[i];
        folded_step::array array{{name + "." + says.name, {}, {}, to.numbers, says.size()}, says.kind};
        for (const std::size_t extent : says.extents)
            if (extent > 0)
                array.extents.push_back(extent);
        step.arrays.push_back(std::move(array));
        to.numbers += says.size();
    }
    to.steps.push_back(std::move(step));
}
/// The name of a part of a step.
[[nodiscard]] [[gnu::cold, gnu::noinline]] inline std::string
part_name(const std::string& name, const char* part, std::size_t place = 0) {
    return name + (name.empty() || *part == 0 ? "" : ".") + part + (place > 0 ? std::to_string(place) : "");
}

} // namespace detail

/// Rounds weights to whole multiples of their scales, as packing does, so that a file restores them.
[[gnu::cold]] inline void round_weights(const folded_layout& layout, std::span<float> folded) {
    for (const folded_step& step : layout.steps)
        if (const auto *const weights = step.find("weight"), *const scales = step.find("scale");
            weights != nullptr && scales != nullptr) {
            const std::size_t of_one = weights->size / scales->size;
            for (std::size_t i = 0; i < weights->size; ++i) {
                float& weight = folded[weights->offset + i];
                weight = detail::rounded_weight(weight, folded[scales->offset + i / of_one]);
            }
        }
}

// Checks folded numbers of a network in 8 bits: others might overflow sums of 32 bits or give bytes no
// meaning.

/// A wrong folded number.
struct folded_problem {
    std::string array;   ///< its name in the layout; for the frame "input_mean" or "input_words"
    std::size_t element; ///< the index in the array
    std::string expected, found;
};

namespace detail {

/// Scales are normal numbers that cannot overflow a product.
inline constexpr float smallest_scale = std::numeric_limits<float>::min(), largest_scale = 1e30f;

[[nodiscard]] inline std::string short_number(double value) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.9g", value);
    return text;
}

/// Checks one step after the other, and keeps the first problem.
class folded_checker {
public:
    [[gnu::cold]] folded_checker(const folded_layout& layout, std::span<const float> folded)
        : folded_(folded) {
        if (layout.steps_folded > 0)
            check_frame(layout.input.size());
        for (const folded_step& step : layout.steps) {
            if (problem_)
                return;
            check_numbers(step);
            if (!problem_)
                check_sums(step);
        }
    }
    [[nodiscard]] const std::optional<folded_problem>& problem() const { return problem_; }

private:
    [[gnu::cold, gnu::noinline]] void require(bool holds, const std::string& array, std::size_t element,
                                              const char* expected, double found) {
        if (!holds && !problem_)
            problem_ = folded_problem{array, element, expected, short_number(found)};
    }

    [[gnu::cold]] void check_frame(std::size_t size) {
        const float steps = folded_[size], most = folded_[size + 1];
        // A normal number is a power of two if all bits of its mantissa are 0.
        const bool power = steps >= smallest_scale && (detail::bits_as<std::uint32_t>(steps) & 0x7fffff) == 0;
        require(power && steps <= 0x1p14f, "input_words", 0,
                "a power of two, at most 16384, as steps of a count", static_cast<double>(steps));
        require(most > 0 && static_cast<double>(most) * static_cast<double>(steps) <= 32767, "input_words", 1,
                "a number that is at most 32767 steps", static_cast<double>(most));
        for (std::size_t e = 0; e < size; ++e)
            require(std::abs(folded_[e]) <= most && std::abs(255 - folded_[e]) <= most, "input_mean", e,
                    "a mean from which no count of 8 bits is further than the largest number of the words",
                    static_cast<double>(folded_[e]));
    }
    [[gnu::cold]] void check_scale(const std::string& array, std::size_t element, float value) {
        require(value >= smallest_scale && value <= largest_scale, array, element,
                "a scale (a normal number above 0, at most 1e30)", static_cast<double>(value));
    }
    [[gnu::cold]] void check_numbers(const folded_step& step) {
        for (const folded_step::array& array : step.arrays) {
            const float* const values = folded_.data() + array.offset;
            if (array.kind == folded_kind::range) {
                check_scale(array.name, 0, values[0]);
                require(values[1] >= 0 && values[1] <= 255 && values[1] == std::floor(values[1]), array.name,
                        1, "a zero (a whole number from 0 to 255)", static_cast<double>(values[1]));
                continue;
            }
            for (std::size_t i = 0; i < array.size; ++i)
                if (array.kind == folded_kind::scales)
                    check_scale(array.name, i, values[i]);
                else if (array.kind == folded_kind::positive_numbers)
                    require(values[i] > 0 && values[i] <= std::numeric_limits<float>::max(), array.name, i,
                            "a finite number above 0", static_cast<double>(values[i]));
                else
                    require(std::abs(values[i]) <= std::numeric_limits<float>::max(), array.name, i,
                            "a finite number", static_cast<double>(values[i]));
        }
    }
    [[nodiscard]] map_range range_of(const folded_step& step, const char* map) const {
        const folded_step::array* const array = step.find(map);
        return array == nullptr ? map_range{} : map_range::read(folded_.data() + array->offset);
    }
    /// Checks the factor from sums to outputs of the step.
    [[gnu::cold]] void check_factor(const std::string& array, std::size_t element, double unit,
                                    const map_range& output,
                                    const char* expected = "scales whose product over that of the output is "
                                                           "a number of single precision") {
        const double factor = unit / static_cast<double>(output.scale);
        require(factor <= static_cast<double>(std::numeric_limits<float>::max()), array, element, expected,
                factor);
    }
    [[gnu::cold]] void check_sums(const folded_step& step) {
        const step_ranges ranges{range_of(step, "input"), range_of(step, "added"), range_of(step, "output")};
        const folded_step::array *const weights = step.find("weight"), *const biases = step.find("bias"),
                                        *const scales = step.find("scale");
        if (weights == nullptr || biases == nullptr) {
            const auto input = static_cast<double>(ranges.input.scale),
                       added = static_cast<double>(ranges.added.scale);
            if (step.adds)
                return check_factor(step.arrays[0].name, 0, std::max(input, added), ranges.output,
                                    "scales of which each over that of the output is a number of single "
                                    "precision");
            return check_factor(step.arrays[0].name, 0, input * added, ranges.output);
        }
        const bool norm_of_frames = step.find("epsilon") != nullptr;
        for (std::size_t f = 0; f < biases->size && !problem_; ++f) {
            const float bias = folded_[biases->offset + f];
            if (norm_of_frames)
                // The kernel clamps products to 8192 steps: with a larger bias, that could change a byte.
                require(std::abs(static_cast<double>(bias)) <=
                            7936 * static_cast<double>(ranges.output.scale),
                        biases->name, f, "at most 7936 steps of the output", static_cast<double>(bias));
            else if (scales == nullptr)
                check_factor(weights->name, f, norm_unit(folded_[weights->offset + f], bias, ranges.input),
                             ranges.output);
            else
                check_filter(step, *weights, f, bias, folded_[scales->offset + f], ranges);
        }
    }
    [[gnu::cold]] void check_filter(const folded_step& step, const folded_step::array& weights,
                                    std::size_t filter, float bias, float scale, const step_ranges& ranges) {
        const std::size_t of_one = weights.size / weights.extents[0];
        const float* const values = folded_.data() + weights.offset + filter * of_one;
        for (std::size_t i = 0; i < of_one; ++i)
            require(std::abs(static_cast<double>(values[i])) < 127.5 * static_cast<double>(scale),
                    weights.name, filter * of_one + i,
                    "a weight of at most 127 times the scale of its filter", static_cast<double>(values[i]));
        const filter_scale sums = filter_of(values, of_one, static_cast<double>(bias), scale, ranges,
                                            step.find("added") != nullptr, step.largest_input, 0);
        require(sums.fits(), step.find("bias")->name, filter,
                "a filter and a bias whose sums have at most 32 bits, which are 2147483647 steps",
                sums.max_abs_sum);
        check_factor(step.find("scale")->name, filter, sums.unit, ranges.output);
    }

    std::span<const float> folded_;
    std::optional<folded_problem> problem_;
};

/// Returns the first problem of the folded numbers of a layout, if there is one.
[[nodiscard]] [[gnu::cold]] inline std::optional<folded_problem> find_problem(const folded_layout& layout,
                                                                              std::span<const float> folded) {
    return folded_checker(layout, folded).problem();
}

} // namespace detail

}} // namespace tactnet
