#pragma once

#include <tactnet/text/message.hpp>

#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

// One exception for everything that can be wrong with a user's file. Its reader must be able to act on it, so
// it always states which file, where in it, what was expected and what was found.

namespace tactnet { inline namespace TACTNET_ARCH {

/// "file: place: expected …, found …", the sentence of every error about a file. An empty file or place is
/// left out.
[[nodiscard]] [[gnu::cold, gnu::noinline]] inline std::string error_sentence(std::string_view file,
                                                                             std::string_view place,
                                                                             std::string_view expected,
                                                                             std::string_view found) {
    std::string text;
    for (const std::string_view part : {file, place})
        if (!part.empty())
            text = detail::joined({text, part, ": "});
    return detail::joined({text, "expected ", expected, ", found ", found});
}

/// A file that cannot be read, written or used. `what()` is one sentence: "file: place: expected …, found …".
class file_error : public std::runtime_error {
public:
    /// `place` may be empty when the file as a whole is meant.
    [[gnu::cold, gnu::noinline]] file_error(std::string file, std::string place, std::string expected,
                                            std::string found)
        : std::runtime_error(error_sentence(file, place, expected, found)),
          parts_(std::make_shared<const parts>(
              parts{std::move(file), std::move(place), std::move(expected), std::move(found)})) {}

    /// The file or folder, as the caller named it.
    const std::string& file() const noexcept { return parts_->file; }
    /// Where in the file: a tensor, a byte, a pixel. Empty for the whole file.
    const std::string& place() const noexcept { return parts_->place; }
    const std::string& expected() const noexcept { return parts_->expected; }
    const std::string& found() const noexcept { return parts_->found; }

private:
    struct parts {
        std::string file, place, expected, found;
    };

    // Shared, since copying an exception must not throw.
    std::shared_ptr<const parts> parts_;
};

namespace detail {

/// Throws file_error with each text put together out of line.
[[noreturn]] [[gnu::cold, gnu::noinline]] inline void
throw_file_error(std::string_view file, text_parts place, text_parts expected, text_parts found) {
    throw file_error(std::string(file), joined(place), joined(expected), joined(found));
}

} // namespace detail

}} // namespace tactnet
