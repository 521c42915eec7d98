#pragma once

// Tables that a study reads beside its own, from files that hold a given text.

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/write_file.hpp>

#include <string>
#include <string_view>
#include <support/files/temporary_folder.hpp>

namespace support {

/// What `Read` finds in a file of that text.
template <auto Read>
auto read_table(std::string_view text) {
    const temporary_folder folder;
    const auto path = folder / "table.csv";
    tactnet::write_file(path, text);
    return Read(path);
}

/// What its error says behind the name of the file.
template <auto Read>
std::string refused_table(std::string_view text) {
    try {
        (void)read_table<Read>(text);
    } catch (const tactnet::file_error& error) {
        return error.place() + ": expected " + error.expected() + ", found " + error.found();
    }
    return "nothing";
}

} // namespace support
