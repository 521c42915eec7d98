#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/eight_bit/checks.hpp>
#include <tactnet/deployment/eight_bit/layout_of.hpp>

#include <span>
#include <stdexcept>
#include <string>

namespace tactnet {
inline namespace TACTNET_ARCH {
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
