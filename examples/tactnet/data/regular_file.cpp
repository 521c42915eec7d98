#include "data/regular_file.hpp"

#include <tactnet/io/file_error.hpp>

#include <system_error>

void check_no_device(const std::filesystem::path& path) {
    using std::filesystem::file_type;
    std::error_code code;
    const file_type type = std::filesystem::status(path, code).type();
    const char* found = type == file_type::fifo                                    ? "a named pipe"
                        : type == file_type::socket                                ? "a socket"
                        : type == file_type::character || type == file_type::block ? "a device"
                                                                                   : nullptr;
    if (found == nullptr)
        return;
    // A pipe between two programs has no name of its own: it ends when the other one does.
    static_cast<void>(std::filesystem::canonical(path, code));
    if (!code)
        throw tactnet::file_error(path.string(), "", "a regular file", found);
}
