#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <tuple>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// The ways to compute one thing, and which of them is taken. Each method has the constants `applicable` and
/// `cost`; costs of one list have one unit. The cost of a method that is not applicable is never evaluated.
template <class... Methods>
class method_list {
    template <class Method>
    static constexpr std::size_t cost_of() {
        if constexpr (Method::applicable)
            return Method::cost;
        else
            return std::numeric_limits<std::size_t>::max();
    }
    static constexpr std::array<std::size_t, sizeof...(Methods)> costs{cost_of<Methods>()...};
    static constexpr auto least = std::min_element(costs.begin(), costs.end()) - costs.begin();
    static_assert((Methods::applicable || ...), "method_list: expected at least one applicable method");

public:
    /// The applicable method of the least cost; of several, the first in the list.
    using cheapest = std::tuple_element_t<static_cast<std::size_t>(least), std::tuple<Methods...>>;
};

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
