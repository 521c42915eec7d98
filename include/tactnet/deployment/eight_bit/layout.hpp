#pragma once

#include <tactnet/deployment/eight_bit/format.hpp>
#include <tactnet/deployment/eight_bit/quantise.hpp>
#include <tactnet/tensor/named_array.hpp>
#include <tactnet/tensor/shape.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// The folded numbers of a network in 8 bits, array by array with a name for each, as the steps say them: for
// what checks them and keeps them in files, which need not know the network's type. A network's own is made
// by layout_of.hpp.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The arrays of one step.
struct folded_step {
    /// One of them.
    struct array : named_array {
        folded_kind kind; ///< what its numbers are
    };
    std::string name; ///< "step2", "step3.main.step1": its place in the network, with all that it is part of
    double largest_input = 0;  ///< of a step with weights
    std::vector<array> arrays; ///< in the order of the folded numbers

    /// The array that the step calls so, or none.
    [[nodiscard]] const array* find(std::string_view array_name) const {
        for (const array& a : arrays)
            if (std::string_view(a.name).substr(name.size() + 1) == array_name)
                return &a;
        return nullptr;
    }
};
/// In the order of the folded numbers.
struct folded_layout {
    shape input;
    std::size_t outputs = 0;
    std::size_t steps_folded = 0;   ///< numbers in front of those of the steps, of the frame
    std::size_t numbers = 0;        ///< all of them
    bool ends_in_weights = false;   ///< whether the last step has a filter for each output
    std::vector<folded_step> steps; ///< those with folded numbers
};

namespace detail {

// What the templates of layout_of.hpp have in common. Not inlined: text is not worth the compiler's time.

/// Appends a step with these arrays.
[[gnu::cold, gnu::noinline]] inline void append_step(folded_layout& to, const std::string& name,
                                                     const folded_arrays& arrays, double largest_input) {
    folded_step step{name, largest_input, {}};
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
/// Of a part of a step.
[[nodiscard]] [[gnu::cold, gnu::noinline]] inline std::string
part_name(const std::string& name, const char* part, std::size_t place = 0) {
    return name + (name.empty() || *part == 0 ? "" : ".") + part + (place > 0 ? std::to_string(place) : "");
}

} // namespace detail

/// Weights that are no whole multiples of their scales become the nearest ones, as they are packed: what a
/// file gives back.
[[gnu::cold]] inline void round_weights(const folded_layout& layout, std::span<float> folded) {
    for (const folded_step& step : layout.steps)
        if (const auto* const weights = step.find("weight"), * const scales = step.find("scale");
            weights != nullptr && scales != nullptr) {
            const std::size_t of_one = weights->size / scales->size;
            for (std::size_t i = 0; i < weights->size; ++i) {
                float& weight = folded[weights->offset + i];
                const float scale = folded[scales->offset + i / of_one];
                weight = static_cast<float>(detail::quantised(weight, static_cast<double>(scale))) * scale;
            }
        }
}

} // namespace TACTNET_ARCH
} // namespace tactnet
