#include "data/fingerprint.hpp"

#include "data/regular_file.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/read_file.hpp>

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <ios>
#include <vector>

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
        for (std::streamsize i = 0; i < file.gcount(); ++i)
            print.mix(static_cast<std::uint8_t>(piece[static_cast<std::size_t>(i)]));
    }
    if (!file.eof())
        throw tactnet::file_error(path.string(), "", "a readable file", "none");
    print.mix(0xFF); // as at the end of a text
    return print.text();
}
