#include "data/input_file.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>

#include <fmt/format.h>

#include <cstddef>
#include <fstream>
#include <ios>
#include <span>
#include <system_error>
#include <vector>

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

std::string fingerprint::text() const {
    return fmt::format("{:016x}", hash_);
}

std::string file_fingerprint(const std::filesystem::path& path) {
    check_no_device(path);
    // In pieces: weights may be hundreds of megabytes.
    std::ifstream file(path, std::ios::binary);
    if (!file)
        static_cast<void>(tactnet::read_file(path)); // which says why
    std::vector<char> piece(std::size_t{1} << 20U);
    fingerprint print;
    while (file) {
        file.read(piece.data(), static_cast<std::streamsize>(piece.size()));
        print.mix_all(std::span(piece).first(static_cast<std::size_t>(file.gcount())));
    }
    if (!file.eof())
        throw tactnet::file_error(path.string(), "", "a readable file", "none");
    print.mix(0xFF); // as at the end of a text
    return print.text();
}
