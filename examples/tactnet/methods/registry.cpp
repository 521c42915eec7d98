#include "methods/registry.hpp"

#include "console.hpp"

#include <fmt/ranges.h>

#include <algorithm>

const std::vector<std::unique_ptr<method>>& all_methods() {
    static const auto list = make_methods();
    return list;
}

const method& find_method(std::string_view name, std::string_view size) {
    std::string sizes;
    for (const auto& m : all_methods()) {
        if (m->name != name)
            continue;
        if (m->size() == size)
            return *m;
        sizes += (sizes.empty() ? "" : ", ") + m->size();
    }
    if (sizes.empty())
        refuse("--method: expected one of {}, found '{}'", method_names(), name);
    refuse(
        "{}: expected a size that it was compiled for ({}), found '{}'; sizes are chosen when building, by "
        "TACTNET_PROGRAM_SIZES",
        name, sizes, size);
}

std::string default_method() {
    // The paper's best, if it is there; else the first.
    const bool known =
        std::ranges::any_of(all_methods(), [](const auto& m) { return m->name == "tactnet6"; });
    return known ? "tactnet6" : all_methods().front()->name;
}

std::string method_names() {
    std::vector<std::string> names;
    for (const auto& m : all_methods())
        if (std::find(names.begin(), names.end(), m->name) == names.end())
            names.push_back(m->name);
    return fmt::format("{}", fmt::join(names, ", "));
}

void check_capacity(const method& what, const std::string& data, std::size_t classes) {
    if (classes > what.capacity)
        refuse("{}: expected at most {} classes (chosen when building, by TACTNET_PROGRAM_CLASSES), found {}",
               data, what.capacity, classes);
}
