#pragma once

#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/lowering/quantise.hpp>
#include <tactnet/tensor/named_array.hpp>
#include <tactnet/tensor/shape.hpp>

#include <cstddef>
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

}} // namespace tactnet
