#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/eight_bit/layout.hpp>
#include <tactnet/deployment/eight_bit/steps.hpp>
#include <tactnet/operators/lowering.hpp>
#include <tactnet/text/message.hpp>

#include <cstddef>
#include <span>
#include <string>

// The number format of 8 bits: deployed<Network, eight_bit>, its files and its exported headers. To make such
// a network from a trained one, include tactnet/quantisation.hpp. Here is the layout of the folded numbers of
// a network's type, from the descriptions of its steps.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Appends the arrays of a step, or of the steps inside it.
template <class Step>
struct layout_visitor {
    folded_layout& to;
    std::string name;
    std::size_t place = 0;

    template <class... Arguments>
    [[gnu::cold]] void operator()(const char*, const char*, const Arguments&... arguments) {
        if constexpr ((is_inner_step<Arguments> || ...))
            (append_inner(arguments), ...);
        else if constexpr (requires { Step::visit_parts([](const auto&...) {}); })
            Step::visit_parts([&](const auto&... parts) { (append_inner(parts), ...); });
        else if constexpr (requires { Step::arrays; })
            append_step(
                to, name, Step::arrays, Step::largest_input, requires { Step::adds; });
        else
            static_assert(Step::folded_elements == 0,
                          "a step in 8 bits with folded numbers must list its arrays");
    }

private:
    template <class Argument>
    void append_inner(const Argument&) {}
    template <class Inner, step_composition How>
    void append_inner(const inner_step<Inner, How>& inner) {
        step_description<Inner>::visit(
            layout_visitor<Inner>{to, part_name(name, inner.name, inner.numbered ? ++place : 0)});
    }
};

} // namespace detail

/// The layout of a deployed_view or a stream_view in 8 bits.
template <class View>
[[nodiscard]] [[gnu::cold, gnu::noinline]] folded_layout folded_layout_of() {
    using last = typename View::steps::template at<View::steps::size - 1>;
    folded_layout layout{View::input_shape, View::outputs, 0, 0, false, {}};
    if constexpr (requires { View::input_type::arrays; }) // of a stream
        detail::append_step(layout, "frame", View::input_type::arrays, 0);
    else
        layout.steps_folded = layout.numbers = View::steps_folded;
    step_description<typename View::steps>::visit(detail::layout_visitor<typename View::steps>{layout, {}});
    layout.ends_in_weights = requires { last::weights; } && last::output.area() == 1;
    return layout;
}

namespace detail {

[[gnu::cold, gnu::noinline]] inline void require_no_problem(const char* call, const folded_layout& layout,
                                                            std::span<const float> folded) {
    if (const auto p = detail::find_problem(layout, folded))
        throw_invalid_argument({call, ": ", p->array, ", element ", p->element, ": expected ", p->expected,
                                ", found ", p->found});
}

/// For the constructor of `deployed`.
template <>
struct folded_check<eight_bit> {
    template <class View>
    static void require(const char* call, std::span<const float> folded) {
        require_no_problem(call, folded_layout_of<View>(), folded);
    }
};

} // namespace detail
}} // namespace tactnet
