#pragma once

#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <type_traits>

// How one of several methods for the same computation is chosen at compile time. A method is a struct
// template on the description of the computation (a convolution, its sizes and its epilogue) with static
// members:
//   name                what benchmarks print
//   applicable          whether it can compute this description and is worthwhile at its sizes
//   its estimated work, read only if applicable, in the unit of its list: in frame/ product_twentieths of a
//                       multiply-add of a vector, in integer/ vector_instructions, in batch/ half_products,
//                       of a multiply-add of a lane block
//   packed_elements     of weights and biases in the order of use, whole cache lines
//   workspace_elements  of memory while it runs, whole cache lines
//   pack, run           from folded to packed weights; from one map to the next
// A new method is a new file and its name in a list.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

template <class Method>
[[nodiscard]] constexpr std::uint64_t cost_of_method() {
    if constexpr (!Method::applicable)
        return std::numeric_limits<std::uint64_t>::max();
    else if constexpr (requires { Method::product_twentieths; })
        return Method::product_twentieths;
    else if constexpr (requires { Method::vector_instructions; })
        return Method::vector_instructions;
    else
        return Method::half_products;
}
template <class First, class... Rest>
struct cheapest_method {
    using type = First;
};
template <class First, class Second, class... Rest>
struct cheapest_method<First, Second, Rest...>
    : cheapest_method<std::conditional_t<(cost_of_method<Second>() < cost_of_method<First>()), Second, First>,
                      Rest...> {};

} // namespace detail

/// The methods for one description.
template <class... Methods>
struct method_list {
    static_assert((Methods::applicable || ...), "method_list: no method computes this description");
    /// The cheapest applicable method; the first of several that cost the same.
    using cheapest = typename detail::cheapest_method<Methods...>::type;
    /// Calls visit(std::type_identity<Method>{}) for each applicable method.
    template <class Visit>
    static constexpr void for_each_applicable(Visit&& visit) {
        const auto one = [&]<class Method>(std::type_identity<Method> method) {
            if constexpr (Method::applicable)
                visit(method);
        };
        (one(std::type_identity<Methods>{}), ...);
    }
};

/// Packs weights in the order of use: blocks of `block` filters, then [channel][kernel row][kernel column]
/// [filter of the block], with zeros for filters from `filters` to `padded`. `weight(filter, channel, row,
/// column)`.
template <class Weight, class T>
[[gnu::always_inline]] constexpr void pack_taps(const Weight& weight, std::size_t filters, std::size_t padded,
                                                std::size_t block, std::size_t channels, extent2d kernel,
                                                T* to) {
    for (std::size_t first = 0; first < padded; first += block)
        for (std::size_t channel = 0; channel < channels; ++channel)
            for (std::size_t row = 0; row < kernel.rows; ++row)
                for (std::size_t column = 0; column < kernel.columns; ++column)
                    for (std::size_t f = first; f < std::min(first + block, padded); ++f)
                        *to++ = f < filters ? weight(f, channel, row, column) : T{};
}

}}} // namespace tactnet::kernels
