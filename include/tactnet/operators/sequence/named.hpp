#pragma once

#include <tactnet/operators/sequence/layer.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string_view>
#include <utility>

// Names for the layers of a list, so that weight files keep the names of their authors. A layer without one
// has the name of its kind with a number: "conv1", "bn1".

namespace tactnet { inline namespace TACTNET_ARCH {

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
