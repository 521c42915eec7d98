#pragma once

#include <tactnet/detail/indexed_leaves.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/layers/layer.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// Whether a list has named a layer (named.hpp).
template <class Spec>
concept has_given_name = requires {
    requires Spec::has_given_name;
};

/// A layer at its place in a list. Offsets count from the start of the list's arrays.
template <class Layer, std::size_t Parameters, std::size_t Statistics>
struct placed {
    using type = Layer;
    static constexpr std::size_t parameter_offset = Parameters, statistic_offset = Statistics;
};

/// Lets shapes and offsets flow through the list.
template <class T, shape Input, class Placed, class... Specs>
struct chain {
    using layers = Placed;
    static constexpr shape output = Input;
};
template <class T, shape Input, class... Placed, class Spec, class... Rest>
struct chain<T, Input, indexed_leaves<Placed...>, Spec, Rest...> {
    using here = typename Spec::template layer<T, Input>;
    static constexpr std::size_t parameters = (std::size_t{0} + ... + Placed::type::parameters);
    static constexpr std::size_t statistics = (std::size_t{0} + ... + Placed::type::statistics);
    using next =
        chain<T, here::output, indexed_leaves<Placed..., placed<here, parameters, statistics>>, Rest...>;
    using layers = typename next::layers;
    static constexpr shape output = next::output;
};

} // namespace detail

/// What a list of layers is when it is bound to an input shape: its layers and where their arrays begin, what
/// it costs, and which layers write over their input.
template <class T, shape Input, class... Specs>
class layer_list {
    using chained = detail::chain<T, Input, detail::indexed_leaves<>, Specs...>;
    template <std::size_t I>
    using place = decltype(detail::type_at<I>(std::declval<typename chained::layers>()));
    template <class... Placed>
    static constexpr std::array<layer_costs, sizeof...(Placed)>
    costs_of_all(std::type_identity<detail::indexed_leaves<Placed...>>) {
        return {costs_of_layer<typename Placed::type>...};
    }
    static constexpr std::array<layer_costs, sizeof...(Specs)> of_each =
        costs_of_all(std::type_identity<typename chained::layers>{});
    static constexpr layer_costs all = detail::costs_of_list(Input, of_each);

public:
    static constexpr std::size_t size = sizeof...(Specs);
    template <std::size_t I>
    using at = typename place<I>::type;
    /// Where the arrays of layer I begin in those of the list.
    template <std::size_t I>
    static constexpr std::size_t parameter_offset = place<I>::parameter_offset;
    template <std::size_t I>
    static constexpr std::size_t statistic_offset = place<I>::statistic_offset;

    using value_type = T;
    static constexpr shape input = Input, output = chained::output;
    static constexpr bool keeps_output = all.keeps_output;

    /// Whether layer I may write over its input.
    template <std::size_t I>
    static constexpr bool overwrites() {
        return detail::overwriting(of_each)[I];
    }
    template <std::size_t I>
    static constexpr std::size_t source() { // the layer whose buffer holds the output of layer I
        if constexpr (overwrites<I>())
            return source<I - 1>();
        else
            return I;
    }
    /// Outputs of the list are the caller's memory, all others its own.
    template <std::size_t I>
    static constexpr bool is_last() {
        return source<I>() == source<size - 1>();
    }

    static constexpr std::size_t parameters = all.parameters, statistics = all.statistics;
    static constexpr std::size_t multiply_adds = all.multiply_adds,
                                 multiply_adds_on_pixels = all.multiply_adds_on_pixels;
    /// Elements that must be held at once while one sample passes layer by layer, beside input and
    /// output.
    static constexpr std::size_t inner_activations = all.inner_activations;

    /// Appends the arrays of all layers: each under the name that it was given, or that of its kind, with a
    /// number where there are many.
    static void describe(const std::string& prefix, std::vector<parameter>& list) {
        kernels::unroll<size>([&](auto i) {
            std::string own(kinds[i]);
            if (!spec_given<i> && (spec_numbered<i> || same_kind<i>(size) > 1))
                own += std::to_string(same_kind<i>(i) + 1);
            const std::size_t first = list.size();
            at<i>::describe(joined_name(prefix, own), list);
            for (std::size_t p = first; p < list.size(); ++p)
                list[p].offset +=
                    learnable(list[p].what) ? place<i>::parameter_offset : place<i>::statistic_offset;
        });
    }

private:
    static constexpr std::array<std::string_view, size> kinds{Specs::name...};
    /// Of the first layers those that are of the kind of layer I.
    template <std::size_t I>
    static consteval std::size_t same_kind(std::size_t first) {
        return static_cast<std::size_t>(
            std::count(kinds.begin(), kinds.begin() + static_cast<std::ptrdiff_t>(first), kinds[I]));
    }
    template <std::size_t I>
    static constexpr bool spec_numbered = std::array<bool, size>{Specs::numbered...}[I];
    template <std::size_t I>
    static constexpr bool spec_given = std::array<bool, size>{detail::has_given_name<Specs>...}[I];
};

} // namespace TACTNET_ARCH
} // namespace tactnet
