#pragma once

#include <algorithm>
#include <string_view>

namespace benchmark {

/// Whether an option's list of names, separated by commas, has this one; an empty list has all.
[[nodiscard]] inline bool listed(std::string_view list, std::string_view name) {
    if (list.empty())
        return true;
    while (!list.empty()) {
        const std::string_view one = list.substr(0, list.find(','));
        if (one == name)
            return true;
        list.remove_prefix(std::min(one.size() + 1, list.size()));
    }
    return false;
}

} // namespace benchmark
