#pragma once

#include <tactnet/networks/recognition.hpp>

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

/// Whether each class is the partner of its partner.
[[nodiscard]] inline bool are_mutual(const std::vector<std::size_t>& partners) {
    for (std::size_t c = 0; c < partners.size(); ++c)
        if (partners[c] >= partners.size() || partners[partners[c]] != c)
            return false;
    return true;
}

/// Throws std::invalid_argument unless the partners are those of so many classes, or of the first of them.
[[gnu::cold, gnu::noinline]] inline void check_partners(const char* caller, const reflection_rule& rule,
                                                        std::size_t classes) {
    for (const auto& partners : {rule.rows.partners, rule.columns.partners})
        if (partners.size() > classes || !are_mutual(partners))
            throw std::invalid_argument(std::string(caller) + ": expected partners in pairs among " +
                                        std::to_string(classes) + " classes, found others");
}

} // namespace detail

}} // namespace tactnet
