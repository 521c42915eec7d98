#pragma once

// The words of a command line, and names of files in them, as UTF-8.

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// The name of a file from UTF-8: of other text, libraries for Windows make different names.
inline std::filesystem::path path_of(std::string_view name) {
    return std::u8string(name.begin(), name.end());
}

/// Made at the beginning of a program. On Windows, standard input and output become binary, so that a
/// recording passes unchanged and results have the same bytes as elsewhere, a console shows UTF-8, and with
/// the universal run-time library (UCRT) so is text that becomes a name of a file.
class program_arguments {
public:
    program_arguments(int count, char** words);

    /// Those after the program's name; elsewhere as `main` gets them.
    [[nodiscard]] std::span<const char* const> words() const { return pointers_; }

private:
    std::vector<std::string> texts_;
    std::vector<const char*> pointers_;
};
