#pragma once

#include <tactnet/networks/recognition.hpp>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A rule with partners of its own.
using reflection_rule = basic_reflection_rule<std::vector<std::size_t>>;

/// Refers to a rule, which must outlive the view.
[[nodiscard]] inline reflection_rule_view view_of(const reflection_rule& rule) noexcept {
    return {{rule.rows.reflects, rule.rows.partners}, {rule.columns.reflects, rule.columns.partners}};
}
reflection_rule_view view_of(const reflection_rule&&) = delete;

namespace detail {

/// Throws std::invalid_argument unless all partners are among so many classes.
[[gnu::cold, gnu::noinline]] inline void check_partners(const char* caller, const reflection_rule& rule,
                                                        std::size_t classes) {
    for (const auto& partners : {rule.rows.partners, rule.columns.partners})
        if (std::any_of(partners.begin(), partners.end(), [&](std::size_t p) { return p >= classes; }))
            throw std::invalid_argument(std::string(caller) + ": expected partners among " +
                                        std::to_string(classes) + " classes, found one beyond them");
}

} // namespace detail

}} // namespace tactnet
