#pragma once

#include <tactnet/detail/config.hpp>

#include <memory>
#include <stdexcept>
#include <string>
#include <utility>

// One exception for all that can be wrong with a user's file. Whoever reads it must be able to act on it, so
// it cannot be made without saying which file, where in it, what was expected and what was found.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A file that cannot be read, written or used. `what()` is one sentence: "file: place: expected …, found …".
class file_error : public std::runtime_error {
public:
    /// `place` may be empty when the file as a whole is meant.
    file_error(std::string file, std::string place, std::string expected, std::string found)
        : std::runtime_error(sentence(file, place, expected, found)),
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

    static std::string sentence(const std::string& file, const std::string& place,
                                const std::string& expected, const std::string& found) {
        return file + ": " + (place.empty() ? "" : place + ": ") + "expected " + expected + ", found " +
               found;
    }

    // Shared, since copying an exception must not throw.
    std::shared_ptr<const parts> parts_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
