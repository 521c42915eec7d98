#include "files/places.hpp"

#include "files/try_name.hpp"
#include "reports/report.hpp"
#include "usage_error.hpp"

#include <tactnet/io/partial_file.hpp>

#include <fmt/format.h>

#include <printable.hpp>
#include <set>
#include <system_error>

void check_places(const std::vector<named_file>& inputs, const std::vector<named_file>& outputs,
                  const std::filesystem::path& data) {
    for (const named_file& output : outputs)
        check_writable(output.path);
    check_distinct(inputs, outputs);
    if (!data.empty())
        check_outside_classes(data, outputs);
    for (const named_file& output : outputs)
        try_name(output.path);
}

void check_regular(const std::vector<named_file>& outputs) {
    for (const auto& [option, path] : outputs) {
        std::error_code code;
        const auto status = std::filesystem::status(path, code);
        if (std::filesystem::is_directory(status))
            throw usage_error(fmt::format("{}: expected the name of a file to write, found a folder at {}",
                                          option, printable(path.string())));
        if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
            throw usage_error(fmt::format("{}: expected the name of a file, found a device or a pipe at {}",
                                          option, printable(path.string())));
    }
}

std::vector<named_file> picture_files(const std::string& option, const std::filesystem::path& stem) {
    std::vector<named_file> files;
    for (const char* ending : {".csv", ".png", ".gp"})
        files.push_back({option, stem.string() + ending});
    return files;
}

void tidy_folders_of(const std::vector<named_file>& outputs) {
    std::set<std::filesystem::path> folders;
    for (const named_file& output : outputs)
        if (const auto folder = output.path.parent_path(); folders.insert(folder).second) {
            tactnet::remove_abandoned_files(folder);
            remove_abandoned_trials(folder);
        }
}
