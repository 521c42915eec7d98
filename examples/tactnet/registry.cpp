#include "registry.hpp"

#include "usage_error.hpp"

#include <fmt/format.h>

#include <algorithm>

const std::vector<std::unique_ptr<method>>& all_methods() {
    static const auto list = make_methods();
    return list;
}

const method& find_method(std::string_view name, std::size_t rows, std::size_t columns) {
    std::string sizes;
    for (const auto& m : all_methods()) {
        if (m->name != name)
            continue;
        if (m->rows == rows && m->columns == columns)
            return *m;
        sizes += fmt::format("{}{}x{}", sizes.empty() ? "" : ", ", m->rows, m->columns);
    }
    if (sizes.empty())
        throw usage_error(fmt::format("--network: expected one of {}, found '{}'", network_names(), name));
    throw usage_error(
        fmt::format("--rows, --columns: expected a size that {} was compiled for ({}), found {}x{}; "
                    "sizes are chosen when building, by TACTNET_PROGRAM_SIZES",
                    name, sizes, rows, columns));
}

std::string network_names() {
    std::vector<std::string> names;
    for (const auto& m : all_methods())
        if (std::find(names.begin(), names.end(), m->name) == names.end())
            names.push_back(m->name);
    std::string text;
    for (const std::string& name : names)
        text += (text.empty() ? "" : ", ") + name;
    return text;
}

void check_capacity(const method& network, const std::string& data, std::size_t classes) {
    if (classes > network.capacity)
        throw tactnet::file_error(
            data, "",
            fmt::format("at most {} classes (chosen when building, by TACTNET_PROGRAM_CLASSES)",
                        network.capacity),
            fmt::to_string(classes));
}
