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

/// For the constructor of `deployed`.
template <>
struct folded_check<eight_bit> {
    template <class View>
    static void require(std::span<const float> folded) {
        const folded_checker checker(folded_layout_of<View>(), folded);
        if (const auto& p = checker.problem())
            throw std::invalid_argument("deploy: " + p->array + ", element " + std::to_string(p->element) +
                                        ": expected " + p->expected + ", found " + p->found);
    }
};

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet
