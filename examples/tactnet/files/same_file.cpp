#include "files/same_file.hpp"

#include "usage_error.hpp"

#include <tactnet/text/quoting.hpp>

#include <fmt/format.h>

#include <cstddef>
#include <iterator>
#include <system_error>

namespace {

/// The name without links, those included that lead to nothing yet: a file may be made there meanwhile.
std::filesystem::path resolved(const std::filesystem::path& path) {
    std::error_code code;
    std::filesystem::path result = std::filesystem::absolute(path, code);
    for (int links = 0; links < 40 && std::filesystem::is_symlink(result, code); ++links)
        result = result.parent_path() / std::filesystem::read_symlink(result, code);
    const auto canonical = std::filesystem::weakly_canonical(result, code);
    return code ? result.lexically_normal() : canonical;
}

void check_pair(const named_file& a, const named_file& b) {
    if (!same_file(a.path, b.path))
        return;
    const std::string found = tactnet::in_quotes(a.path.string()),
                      other = tactnet::in_quotes(b.path.string());
    throw usage_error(
        fmt::format("{} and {}: expected different files, found {}{}", a.option, b.option, found,
                    found == other ? " for both" : fmt::format(" and {}, which are the same", other)));
}

} // namespace

bool same_file(const std::filesystem::path& a, const std::filesystem::path& b) {
    std::error_code code;
    return (std::filesystem::equivalent(a, b, code) && !code) || resolved(a) == resolved(b);
}

void check_distinct(const std::vector<named_file>& inputs, const std::vector<named_file>& outputs) {
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        for (const named_file& input : inputs)
            if (!input.path.empty())
                check_pair(input, outputs[i]);
        for (std::size_t j = i + 1; j < outputs.size(); ++j)
            check_pair(outputs[i], outputs[j]);
    }
}

void check_outside_classes(const std::filesystem::path& data, const std::vector<named_file>& outputs) {
    const std::filesystem::path folder = resolved(data / ".");
    for (const named_file& output : outputs) {
        const std::filesystem::path inside = resolved(output.path).lexically_relative(folder);
        // Hidden folders are no classes; a file beside the classes' folders is none either.
        if (std::distance(inside.begin(), inside.end()) < 2 || inside.begin()->string().starts_with('.'))
            continue;
        throw usage_error(fmt::format("{}: expected a place outside the folders of classes, since what is "
                                      "written there would be taken for images, found {} in {}",
                                      output.option, tactnet::in_quotes(output.path.string()),
                                      tactnet::in_quotes((data / *inside.begin()).string())));
    }
}
