#pragma once

#include <tactnet/detail/indices.hpp>
#include <tactnet/operators/layer.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

// A list of layers bound to an input, and the stages in which a training computes it.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Whether a list gives its layer a name (named.hpp).
template <class Spec>
concept has_given_name = requires { requires Spec::has_given_name; };

// Descriptions of networks are rare calls: the functions below compile once for all networks.

using describe_function = void (*)(const std::string& prefix, std::vector<parameter>& list);

/// Appends the arrays of an inner layer, shifted by its offset.
[[gnu::cold, gnu::noinline]] inline void describe_inner(describe_function describe, const std::string& name,
                                                        const layer_offset& offset,
                                                        std::vector<parameter>& list) {
    const std::size_t first = list.size();
    describe(name, list);
    for (std::size_t p = first; p < list.size(); ++p)
        list[p].offset += learnable(list[p].role) ? offset.parameters : offset.statistics;
}

/// A layer of a list, as its description needs it.
struct listed_description {
    std::string_view kind;
    bool is_numbered, is_named;
    describe_function describe;
};

/// Appends the arrays of all layers of a list, each under its given name, or under the name of its kind with
/// a number if there are several.
[[gnu::cold, gnu::noinline]] inline void describe_list(std::span<const listed_description> layers,
                                                       const layer_offset* offsets, const std::string& prefix,
                                                       std::vector<parameter>& list) {
    for (std::size_t i = 0; i < layers.size(); ++i) {
        std::size_t before = 0, all = 0;
        for (std::size_t other = 0; other < layers.size(); ++other)
            if (layers[other].kind == layers[i].kind)
                ++all, before += other < i ? 1 : 0;
        std::string own(layers[i].kind);
        if (!layers[i].is_named && (layers[i].is_numbered || all > 1))
            own += std::to_string(before + 1);
        describe_inner(layers[i].describe, joined_name(prefix, own), offsets[i], list);
    }
}

/// Binds the specifications of a list one after the other: the output of each is the input of the next.
template <class T, shape Input, class Bound, class... Specs>
struct bound_list {
    using layers = Bound;
    static constexpr shape output = Input;
};
template <class T, shape Input, class... Bound, class Spec, class... Rest>
struct bound_list<T, Input, indexed_leaves<Bound...>, Spec, Rest...> {
    using here = typename Spec::template layer<T, Input>;
    using next = bound_list<T, here::output, indexed_leaves<Bound..., std::type_identity<here>>, Rest...>;
    using layers = typename next::layers;
    static constexpr shape output = next::output;
};

} // namespace detail

/// A list of specifications bound to an input shape: its layers, where their arrays begin, and which layers
/// write over their input.
template <class T, shape Input, class... Specs>
class layer_list : public layer_base<T, Input, sequence<Specs...>> {
    using bound = detail::bound_list<T, Input, detail::indexed_leaves<>, detail::checked<Specs>...>;
    static constexpr std::array<layer_costs, sizeof...(Specs)> costs =
        detail::costs_of_each<detail::checked<Specs>...>(Input);
    static constexpr std::array<detail::layer_offset, sizeof...(Specs)> offsets = detail::offsets_of(costs);

public:
    static constexpr std::size_t size = sizeof...(Specs);
    static constexpr shape output = bound::output;
    static constexpr bool in_place = false; // inner layers are
    template <std::size_t I>
    using at = typename decltype(detail::type_at<I>(std::declval<typename bound::layers>()))::type;
    /// Where the arrays of layer I begin among those of the list.
    template <std::size_t I>
    static constexpr std::size_t parameter_offset = offsets[I].parameters;
    template <std::size_t I>
    static constexpr std::size_t statistic_offset = offsets[I].statistics;

    /// The layer whose buffer holds the output of layer i.
    static constexpr std::size_t source(std::size_t i) {
        while (detail::overwriting(costs)[i])
            --i;
        return i;
    }
    /// Whether layer i writes to the caller's memory, as the last one does.
    static constexpr bool is_last(std::size_t i) { return source(i) == source(size - 1); }

    /// Appends the arrays of all layers, each under its given name, or under the name of its kind with a
    /// number if there are several.
    static void describe(const std::string& prefix, std::vector<parameter>& list) {
        static constexpr auto layers = []<std::size_t... I>(std::index_sequence<I...>) {
            return std::array<detail::listed_description, size>{
                {{detail::checked<Specs>::name, detail::checked<Specs>::numbered,
                  detail::has_given_name<Specs>, [](const std::string& name, std::vector<parameter>& to) {
                      at<I>::describe(name, to);
                  }}...}};
        }(std::index_sequence_for<Specs...>{});
        detail::describe_list(layers, offsets.data(), prefix, list);
    }
};

/// Layers one after the other, as one layer. An empty sequence is the identity.
template <class... Specs>
struct sequence {
    static constexpr std::string_view name = "";
    static constexpr bool numbered = true;
    static constexpr std::size_t size = sizeof...(Specs);

    static constexpr layer_costs costs(const shape& input) {
        return detail::costs_of_list(input, detail::costs_of_each<detail::checked<Specs>...>(input));
    }

    template <class T, shape Input>
    using layer = layer_list<T, Input, Specs...>;
};

namespace detail {

template <class Spec>
struct as_sequence {
    using type = sequence<Spec>;
};
template <class... Specs>
struct as_sequence<sequence<Specs...>> {
    using type = sequence<Specs...>;
};

} // namespace detail

/// A list of layers unchanged, and a single layer as a list of one.
template <class Spec>
using as_sequence = typename detail::as_sequence<Spec>::type;

// Names for the layers of a list, so that weight files keep the names of their authors. A layer without one
// has the name of its kind with a number: "conv1", "bn1".

/// A string literal as a template argument: named<"expand1x1", …>.
template <std::size_t Size>
struct name_text {
    std::array<char, Size> letters{}; ///< and a zero

    constexpr name_text() = default;
    constexpr name_text(const char (&text)[Size]) { std::copy_n(text, Size, letters.begin()); }
    [[nodiscard]] constexpr std::string_view view() const { return {letters.data(), Size - 1}; }
};

/// A layer or a list of layers with a name: inside "layer1", "conv1.weight" becomes "layer1.conv1.weight". An
/// empty name adds nothing to the names inside. Nothing else changes.
template <name_text Name, class Spec>
struct named {
    static constexpr std::string_view name = Name.view();
    static constexpr bool numbered = false, has_given_name = true;

    static constexpr layer_costs costs(const shape& input) { return Spec::costs(input); }

    template <class T, shape Input>
    using layer = typename Spec::template layer<T, Input>;
};

/// A list that adds nothing to the names of its layers.
template <class... Specs>
using unnamed = named<"", sequence<Specs...>>;

namespace detail {

/// A number as a name.
template <std::size_t I>
[[nodiscard]] constexpr auto place_name() {
    constexpr std::size_t digits = [] {
        std::size_t count = 1;
        for (std::size_t rest = I; rest >= 10; rest /= 10)
            ++count;
        return count;
    }();
    name_text<digits + 1> text;
    for (std::size_t rest = I, d = digits; d > 0; rest /= 10)
        text.letters[--d] = static_cast<char>('0' + rest % 10);
    return text;
}

template <class Indices, class... Specs>
struct by_place;
template <std::size_t... I, class... Specs>
struct by_place<std::index_sequence<I...>, Specs...> {
    using type = sequence<named<place_name<I>(), Specs>...>;
};

template <class Spec>
struct without_name {
    using type = Spec;
};
template <name_text Name, class Spec>
struct without_name<named<Name, Spec>> : without_name<Spec> {};

template <name_text Name, class Spec>
struct as_sequence<named<Name, Spec>> : as_sequence<Spec> {};

} // namespace detail

/// A list whose layers are named by their place from 0, counting those without parameters, as in PyTorch's
/// torch.nn.Sequential.
template <class... Specs>
using sequential = typename detail::by_place<std::index_sequence_for<Specs...>, Specs...>::type;

/// The layer or list without its name.
template <class Spec>
using without_name = typename detail::without_name<Spec>::type;

}} // namespace tactnet
