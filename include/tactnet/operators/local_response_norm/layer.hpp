#pragma once

#include <tactnet/kernels/norms.hpp>
#include <tactnet/operators/layer.hpp>

#include <cstddef>
#include <ratio>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

template <std::size_t Size, class Alpha, class Beta, class K>
[[nodiscard]] constexpr shape local_response_output(shape output) {
    static_assert(Size > 0, "local_response_norm: the window must hold at least one channel");
    static_assert(std::ratio_greater_v<K, std::ratio<0>>, "local_response_norm: k must be above zero");
    static_assert(Alpha::num >= 0 && Beta::num >= 0,
                  "local_response_norm: alpha and beta must not be below zero");
    return output;
}

} // namespace detail

/// Local response normalisation across channels (Krizhevsky, Sutskever, Hinton, 2012, section 3.3):
/// y(c) = x(c) · (k + α ÷ size · Σ x(i)²)^−β over the `size` channels around c. As in Caffe, MATLAB and
/// PyTorch, α is divided by the size: the paper's α = 1e-4 at size 5, k = 2, is their 5e-4. If the size is
/// even, one more channel lies before c than after it, as in PyTorch. The constants are fractions
/// (std::ratio).
template <std::size_t Size = 5, class Alpha = std::ratio<1, 10000>, class Beta = std::ratio<3, 4>,
          class K = std::ratio<1>>
struct local_response_norm {
    static constexpr std::string_view name = "lrn";
    static constexpr bool numbered = true;
    using rule = kernels::response_rule<Size, Alpha, Beta, K>;

    static constexpr layer_costs costs(const shape& input) { return {.output = input}; }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, local_response_norm> {
        static constexpr shape output = detail::local_response_output<Size, Alpha, Beta, K>(Input);
    };
};

}} // namespace tactnet
