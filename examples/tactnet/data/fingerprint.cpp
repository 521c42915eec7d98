#include "data/fingerprint.hpp"

#include "data/regular_file.hpp"

#include <tactnet/io/file.hpp>

#include <fmt/format.h>

std::string fingerprint::text() const {
    return fmt::format("{:016x}", hash_);
}

std::string file_fingerprint(const std::filesystem::path& path) {
    check_no_device(path);
    const auto bytes = tactnet::read_file(path);
    fingerprint print;
    print.add(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
    return print.text();
}
