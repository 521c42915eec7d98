#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/eight_bit/checks.hpp>
#include <tactnet/deployment/eight_bit/layout.hpp>
#include <tactnet/deployment/eight_bit/steps.hpp>

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>

// The layout of the folded numbers of a network, from the types of its steps: each says its own arrays, and
// here stands where steps are inside others.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// Appends the steps inside a step, or what it says of itself.
template <class Step>
struct layout_of_step {
    static void append(folded_layout& to, const std::string& name) {
        if constexpr (requires { Step::largest_input; })
            append_step(to, name, Step::arrays, Step::largest_input);
        else if constexpr (requires { Step::arrays; })
            append_step(to, name, Step::arrays, 0);
        else
            static_assert(Step::folded == 0, "a step in 8 bits with folded numbers says its arrays");
    }
};
template <class Step>
struct layout_of_step<step_with_softmax<Step>> : layout_of_step<Step> {};
template <class... Steps>
struct layout_of_step<step_chain<Steps...>> {
    static void append(folded_layout& to, const std::string& name) {
        std::size_t place = 0;
        (layout_of_step<Steps>::append(to, part_name(name, "step", ++place)), ...);
    }
};
template <class Main, class Skip, std::size_t InputStride>
struct layout_of_step<residual_step<Main, Skip, InputStride>> {
    static void append(folded_layout& to, const std::string& name) {
        layout_of_step<Main>::append(to, part_name(name, "main"));
        layout_of_step<Skip>::append(to, part_name(name, "skip"));
    }
};
template <class Format, shape Input, std::size_t InputStride, std::size_t Stride, class... Branches>
struct layout_of_step<concatenation_step<Format, Input, InputStride, Stride, Branches...>> {
    static void append(folded_layout& to, const std::string& name) {
        std::size_t place = 0;
        (layout_of_step<typename Branches::step>::append(to, part_name(name, "branch", ++place)), ...);
    }
};

} // namespace detail

/// Of a deployed_view in 8 bits.
template <class View>
[[nodiscard]] [[gnu::cold, gnu::noinline]] folded_layout folded_layout_of() {
    using last = typename View::steps::template at<View::steps::size - 1>;
    folded_layout layout{View::input_shape, View::outputs, View::steps_folded, View::steps_folded, false, {}};
    detail::layout_of_step<typename View::steps>::append(layout, "");
    layout.ends_in_weights = requires {
        last::weights;
    }
    &&last::output.area() == 1;
    return layout;
}

namespace detail {

[[gnu::cold, gnu::noinline]] inline void require_no_problem(const folded_layout& layout,
                                                            std::span<const float> folded) {
    if (const auto p = find_problem(layout, folded))
        throw std::invalid_argument("deploy: " + p->array + ", element " + std::to_string(p->element) +
                                    ": expected " + p->expected + ", found " + p->found);
}

/// For the constructor of `deployed`.
template <>
struct folded_check<eight_bit> {
    template <class View>
    static void require(std::span<const float> folded) {
        require_no_problem(folded_layout_of<View>(), folded);
    }
};

} // namespace detail

} // namespace TACTNET_ARCH
} // namespace tactnet
