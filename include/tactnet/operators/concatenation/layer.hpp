#pragma once

#include <tactnet/detail/indices.hpp>
#include <tactnet/operators/sequence/layer.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

template <std::size_t Rows, std::size_t Columns, std::size_t FirstRows, std::size_t FirstColumns>
concept maps_agree = (Rows == FirstRows) && (Columns == FirstColumns);

namespace detail {

template <class First, class... Branches>
[[nodiscard]] constexpr shape concatenation_output() {
    static_assert((maps_agree<Branches::output.rows, Branches::output.columns, First::output.rows,
                              First::output.columns> &&
                   ...),
                  "concatenation: all branches must give the same rows and columns; maps_agree shows those "
                  "of a branch, then those of the first");
    return {First::output.rows, First::output.columns,
            (First::output.channels + ... + Branches::output.channels)};
}

/// The costs of branches side by side, each with memory of its own for its output.
template <std::size_t Size>
[[nodiscard]] constexpr layer_costs costs_side_by_side(const std::array<layer_costs, Size>& branches) {
    layer_costs all{.output = {branches[0].output.rows, branches[0].output.columns, 0}};
    for (const layer_costs& branch : branches) {
        all.add(branch);
        all.output.channels += branch.output.channels;
        all.inner_activations = std::max(all.inner_activations, branch.inner_activations);
    }
    all.inner_activations += all.output.size();
    return all;
}

} // namespace detail

/// The channels of several branches over the same input, one branch after the other (Szegedy et al., 2015). A
/// branch is a list of layers or a single one; `identity_layer` passes the input on. The arrays of the
/// branches begin with "branch1", "branch2" …, or with the names that branches are given.
template <class... Branches>
struct concatenation {
    static_assert(sizeof...(Branches) > 0, "concatenation: there must be at least one branch");
    static constexpr std::string_view name = "concat";
    static constexpr bool numbered = true;
    static constexpr std::size_t size = sizeof...(Branches);

    static constexpr layer_costs costs(const shape& input) {
        return detail::costs_side_by_side(std::array{as_sequence<Branches>::costs(input)...});
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, concatenation> {
        template <std::size_t I>
        using at = typename decltype(detail::type_at<I>(
            std::declval<detail::indexed_leaves<
                std::type_identity<typename as_sequence<Branches>::template layer<T, Input>>...>>()))::type;
        static constexpr shape output =
            detail::concatenation_output<typename as_sequence<Branches>::template layer<T, Input>...>();
        /// The channels of the output, parameters and statistics before those of each branch.
        static constexpr std::array<detail::layer_offset, size> offsets =
            detail::offsets_of(std::array{as_sequence<Branches>::costs(Input)...});

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            constexpr std::array<std::string_view, size> given{given_name<Branches>()...};
            constexpr std::array<bool, size> has_name{detail::has_given_name<Branches>...};
            kernels::unroll<size>([&](auto i) {
                const std::string own =
                    has_name[i] ? std::string(given[i]) : "branch" + std::to_string(i + 1);
                detail::describe_inner(at<i>::describe, joined_name(prefix, own), offsets[i], list);
            });
        }

    private:
        template <class Branch>
        static constexpr std::string_view given_name() {
            if constexpr (detail::has_given_name<Branch>)
                return Branch::name;
            else
                return "";
        }
    };
};

}} // namespace tactnet
