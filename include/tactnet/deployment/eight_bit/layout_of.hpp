#pragma once

#include <tactnet/deployment/eight_bit/layout.hpp>
#include <tactnet/deployment/eight_bit/steps.hpp>

#include <cstddef>
#include <string>
#include <utility>

// The layout of the folded numbers of a network, from the types of its steps: each says its own arrays, and
// here stands where steps are inside others.

namespace tactnet {
inline namespace TACTNET_ARCH {

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

} // namespace TACTNET_ARCH
} // namespace tactnet
