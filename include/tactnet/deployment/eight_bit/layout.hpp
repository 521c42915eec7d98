#pragma once

#include <tactnet/deployment/eight_bit/format.hpp>
#include <tactnet/deployment/eight_bit/steps.hpp>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

// The folded numbers of a network in 8 bits, array by array with a name for each, as the steps say them: for
// what checks them and keeps them in files, which need not know the network's type.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The arrays of one step.
struct folded_step {
    struct array {
        std::string name;
        folded_kind kind;
        std::vector<std::size_t> extents;
        std::size_t begin, size; ///< among all folded numbers
    };
    std::string name; ///< "step2", "step3.main.step1": its place in the network, with all that it is part of
    double largest_input = 0; ///< of a step with weights
    std::vector<array> arrays;

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

/// Appends the steps inside a step, or what it says of itself.
template <class Step>
struct layout_of_step {
    static void append(folded_layout& to, const std::string& name) {
        if constexpr (requires { Step::arrays; }) {
            folded_step step{name, 0, {}};
            if constexpr (requires { Step::largest_input; })
                step.largest_input = Step::largest_input;
            for (std::size_t i = 0; i < Step::arrays.count; ++i)
                append_array(to, step, Step::arrays.list[i]);
            to.steps.push_back(std::move(step));
        } else {
            static_assert(Step::folded == 0, "a step in 8 bits with folded numbers says its arrays");
        }
    }

private:
    static void append_array(folded_layout& to, folded_step& step, const folded_array& says) {
        folded_step::array array{step.name + "." + says.name, says.kind, {}, to.numbers, says.size()};
        for (const std::size_t extent : says.extents)
            if (extent > 0)
                array.extents.push_back(extent);
        step.arrays.push_back(std::move(array));
        to.numbers += says.size();
    }
};
template <class... Steps>
struct layout_of_step<step_chain<Steps...>> {
    static void append(folded_layout& to, const std::string& name) {
        std::size_t place = 0;
        (layout_of_step<Steps>::append(to,
                                       (name.empty() ? "step" : name + ".step") + std::to_string(++place)),
         ...);
    }
};
template <class Main, class Skip, std::size_t InputStride>
struct layout_of_step<residual_step<Main, Skip, InputStride>> {
    static void append(folded_layout& to, const std::string& name) {
        layout_of_step<Main>::append(to, name + ".main");
        layout_of_step<Skip>::append(to, name + ".skip");
    }
};
template <class Format, shape Input, std::size_t InputStride, std::size_t Stride, class... Branches>
struct layout_of_step<concatenation_step<Format, Input, InputStride, Stride, Branches...>> {
    static void append(folded_layout& to, const std::string& name) {
        std::size_t place = 0;
        (layout_of_step<typename Branches::step>::append(to, name + ".branch" + std::to_string(++place)),
         ...);
    }
};

} // namespace detail

/// Of a deployed_view in 8 bits.
template <class View>
[[nodiscard]] folded_layout folded_layout_of() {
    using last = typename View::steps::template at<View::steps::size - 1>;
    folded_layout layout{View::input_shape, View::outputs, View::steps_folded, View::steps_folded, false, {}};
    detail::layout_of_step<typename View::steps>::append(layout, "");
    layout.ends_in_weights = requires {
        last::weights;
    }
    &&last::output.area() == 1;
    return layout;
}

/// Weights that are no whole multiples of their scales become the nearest ones, as they are packed: what a
/// file gives back.
inline void round_weights(const folded_layout& layout, std::span<float> folded) {
    for (const folded_step& step : layout.steps)
        if (const auto* const weights = step.find("weight"), * const scales = step.find("scale");
            weights != nullptr && scales != nullptr) {
            const std::size_t of_one = weights->size / scales->size;
            for (std::size_t i = 0; i < weights->size; ++i) {
                float& weight = folded[weights->begin + i];
                const float scale = folded[scales->begin + i / of_one];
                weight = static_cast<float>(detail::quantised(weight, static_cast<double>(scale))) * scale;
            }
        }
}

} // namespace TACTNET_ARCH
} // namespace tactnet
