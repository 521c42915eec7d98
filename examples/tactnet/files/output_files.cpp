#include "files/output_files.hpp"

#include "console.hpp"
#include "files/claims.hpp"

#include <tactnet/io/write_file.hpp>
#include <tactnet/text/message.hpp>

#include <iterator>
#include <set>
#include <system_error>
#if !defined(_WIN32)
#include <unistd.h>
#endif

namespace fs = std::filesystem;

namespace {

/// The name without links, those included that lead to nothing yet: a file may be made there meanwhile.
fs::path resolved(const fs::path& path) {
    std::error_code code;
    fs::path result = fs::absolute(path, code);
    for (int links = 0; links < 40 && fs::is_symlink(result, code); ++links)
        result = result.parent_path() / fs::read_symlink(result, code);
    const auto canonical = fs::weakly_canonical(result, code);
    return code ? result.lexically_normal() : canonical;
}

void check_pair(const named_file& a, const named_file& b) {
    std::error_code code;
    if (!(fs::equivalent(a.path, b.path, code) && !code) && resolved(a.path) != resolved(b.path))
        return;
    const std::string found = tactnet::in_quotes(a.path.string()),
                      other = tactnet::in_quotes(b.path.string());
    refuse("{} and {}: expected different files, found {}{}", a.option, b.option, found,
           found == other ? " for both" : fmt::format(" and {}, which are the same", other));
}

/// Throws usage_error unless a file could be written there, in folders that need not exist yet.
void check_writable(const fs::path& path) {
    const auto refuse_path = [&](const char* expected, const std::string& found) {
        refuse("{}: expected {}, found {}", path.string(), expected, found);
    };
    std::error_code code;
    if (path.filename().empty() || fs::is_directory(path, code))
        refuse_path("the name of a file to write", "a folder");
    // Opening one waits for a reader, perhaps for ever. Those that a shell makes (/dev/fd) have one.
    if (fs::is_fifo(path, code) && !fs::is_symlink(path, code))
        refuse_path("a regular file", "a named pipe");
    const fs::path whole = fs::absolute(path).lexically_normal();
    fs::path folder = whole.parent_path();
    while (!fs::exists(folder, code) && folder != folder.parent_path())
        folder = folder.parent_path();
    if (!fs::is_directory(folder, code))
        refuse_path("a folder to write in", "a file at " + folder.string());
#if !defined(_WIN32) // where a folder has no such permissions
    if (::access(folder.c_str(), W_OK | X_OK) != 0)
        refuse_path("a folder to write in", "no permission for " + folder.string());
#endif
    // Each name by itself, since what is in a missing folder is not looked at.
    for (const fs::path& name : whole.lexically_relative(folder))
        if (fs::symlink_status(folder / name, code).type() == fs::file_type::none)
            refuse_path("the name of a file that can be written", fmt::format("'{}'", code.message()));
}

/// Throws usage_error where an output would lie in a subfolder of `data`, which is a class of images:
/// pictures of results would become images of it.
void check_outside_classes(const fs::path& data, const std::vector<named_file>& outputs) {
    const fs::path folder = resolved(data / ".");
    for (const named_file& output : outputs) {
        const fs::path inside = resolved(output.path).lexically_relative(folder);
        // Hidden folders are no classes; nor is a file next to the classes' folders.
        if (std::distance(inside.begin(), inside.end()) < 2 || inside.begin()->string().starts_with('.'))
            continue;
        refuse("{}: expected a place outside the folders of classes, since what is "
               "written there would be taken for images, found {} in {}",
               output.option, tactnet::in_quotes(output.path.string()),
               tactnet::in_quotes((data / *inside.begin()).string()));
    }
}

} // namespace

void check_outputs(const std::vector<named_file>& inputs, const std::vector<named_file>& outputs,
                   const fs::path& data) {
    for (const named_file& output : outputs)
        check_writable(output.path);
    for (std::size_t i = 0; i < outputs.size(); ++i) {
        for (const named_file& input : inputs)
            if (!input.path.empty())
                check_pair(input, outputs[i]);
        for (std::size_t j = i + 1; j < outputs.size(); ++j)
            check_pair(outputs[i], outputs[j]);
    }
    if (!data.empty())
        check_outside_classes(data, outputs);
    std::set<fs::path> folders;
    for (const named_file& output : outputs)
        if (const auto folder = output.path.parent_path(); folders.insert(folder).second) {
            tactnet::remove_abandoned_files(folder);
            remove_abandoned_claims(folder);
            std::error_code ignored; // perhaps a slip of the pen, or a disk that is not mounted
            if (folder.has_parent_path() && !fs::exists(folder.parent_path(), ignored))
                tell("{}: neither this folder nor the one above it is there; they will be made\n",
                     printable(folder.string()));
        }
}

void check_regular(const std::vector<named_file>& outputs) {
    for (const auto& [option, path] : outputs) {
        std::error_code code;
        const auto status = fs::status(path, code);
        if (fs::exists(status) && !fs::is_regular_file(status))
            refuse("{}: expected the name of a file to write, found {} at {}", option,
                   fs::is_directory(status) ? "a folder" : "a device or a pipe", printable(path.string()));
    }
}

void add_picture(std::vector<named_file>& outputs, const std::string& option, const fs::path& stem) {
    for (const char* ending : {".csv", ".png"})
        outputs.push_back({option, stem.string() + ending});
}

void make_folder_of(const fs::path& path) {
    std::error_code code;
    if (path.has_parent_path())
        fs::create_directories(path.parent_path(), code);
    if (code)
        refuse("{}: expected to make the folder, found '{}'", path.parent_path().string(), code.message());
    tactnet::remove_abandoned_files(path.parent_path());
}
