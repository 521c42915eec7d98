#pragma once

#include <tactnet/operators/sequence/layer.hpp>

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t MainRows, std::size_t MainColumns, std::size_t MainChannels, std::size_t SkipRows,
          std::size_t SkipColumns, std::size_t SkipChannels>
concept branches_agree =
    (MainRows == SkipRows) && (MainColumns == SkipColumns) && (MainChannels == SkipChannels);

namespace detail {

template <std::size_t MainRows, std::size_t MainColumns, std::size_t MainChannels, std::size_t SkipRows,
          std::size_t SkipColumns, std::size_t SkipChannels>
[[nodiscard]] constexpr shape residual_output() {
    static_assert(
        branches_agree<MainRows, MainColumns, MainChannels, SkipRows, SkipColumns, SkipChannels>,
        "residual: both branches must give the same shape; branches_agree shows rows, columns and channels "
        "of the main branch, then those of the skip");
    return {MainRows, MainColumns, MainChannels};
}

/// The costs of the sum of two branches. A projection needs memory of its own.
[[nodiscard]] constexpr layer_costs costs_of_sum(const layer_costs& main, const layer_costs& skip,
                                                 bool projects) {
    const std::size_t map = main.output.size();
    layer_costs sum{.output = main.output,
                    .inner_activations =
                        (main.keeps_output ? map : 0) +
                        std::max(main.inner_activations, projects ? map + skip.inner_activations : 0)};
    sum.add(main);
    sum.add(skip);
    return sum;
}

} // namespace detail

/// The skip of a residual block without a projection.
using identity_layer = sequence<>;

/// Residual block (He, Zhang, Ren, Sun, 2016): main(x) + skip(x), where skip is `identity_layer` or a
/// projection. A branch is a list of layers or a single one. The ReLU after the sum is a layer of its own.
/// The arrays of the skip begin with "projection", or with the name that it is given.
template <class Main, class Skip = identity_layer>
struct residual {
    static constexpr std::string_view name = "block";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return detail::costs_of_sum(as_sequence<Main>::costs(input), as_sequence<Skip>::costs(input),
                                    as_sequence<Skip>::size > 0);
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, residual> {
        using main = typename as_sequence<Main>::template layer<T, Input>;
        using skip = typename as_sequence<Skip>::template layer<T, Input>;
        static constexpr shape output =
            detail::residual_output<main::output.rows, main::output.columns, main::output.channels,
                                    skip::output.rows, skip::output.columns, skip::output.channels>();
        static constexpr bool projects = as_sequence<Skip>::size > 0;

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            main::describe(prefix, list);
            detail::describe_inner(skip::describe, joined_name(prefix, std::string(skip_name)),
                                   {.parameters = main::parameters, .statistics = main::statistics}, list);
        }

    private:
        static constexpr std::string_view skip_name = [] {
            if constexpr (detail::has_given_name<Skip>)
                return Skip::name;
            else
                return std::string_view("projection");
        }();
    };
};

}} // namespace tactnet
