#pragma once

#include <tactnet/sensors/decoder.hpp>
#include <tactnet/sensors/tekscan/header.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/sensors/warning.hpp>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

// The text header of a Tekscan binary recording, up to the bytes 0A BB BA.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Collects the bytes of the header and reads it as a whole.
class tekscan_binary_header {
public:
    /// The largest number of cells: larger cell numbers are marks.
    static constexpr std::size_t largest_cells = 0xFEFF;

    /// Takes bytes up to the end of the header, and returns their number. When the header is complete, fills
    /// `to` and adds warnings about control characters.
    std::size_t consume(std::span<const std::byte> bytes, recording_description& to,
                        decoding_warnings& warnings) {
        const std::size_t before = text_.size();
        const std::size_t consumed = std::min(bytes.size(), largest_header_bytes - before);
        text_.append(reinterpret_cast<const char*>(bytes.data()), consumed);
        const std::size_t from = before - std::min(before, mark.size() - 1);
        const std::size_t end = text_.find(mark, from);
        if (end != std::string::npos) {
            text_.resize(end);
            read(to, warnings);
            text_ = {};
            complete_ = true;
            return end + mark.size() - before;
        }
        if (consumed < bytes.size())
            refuse(
                text_.size(), 0,
                {"a header of at most " + std::to_string(largest_header_bytes) + " bytes", "a longer one"});
        return consumed;
    }

    [[nodiscard]] bool complete() const noexcept { return complete_; }
    /// The error in the header, if any.
    [[nodiscard]] const std::optional<decoding_error>& problem() const noexcept { return problem_; }

private:
    static constexpr std::string_view mark = "\n\xBB\xBA";

    void read(recording_description& to, decoding_warnings& warnings) {
        tekscan_header header(tekscan_header::unit_of::display);
        std::string_view rest = text_;
        for (std::size_t line = 1; !rest.empty(); ++line) {
            const std::size_t length = std::min(rest.find('\n'), rest.size());
            std::string_view text = rest.substr(0, length);
            if (text.ends_with('\r'))
                text.remove_suffix(1);
            const auto byte = static_cast<std::size_t>(text.data() - text_.data());
            look_for_control(text, byte, line, warnings);
            if (auto problem = header.push_line(text, to))
                return refuse(byte, line, std::move(*problem));
            rest.remove_prefix(std::min(length + 1, rest.size()));
        }
        if (auto problem = header.complete(to))
            return refuse(0, 1, std::move(*problem));
        const std::string size = std::to_string(to.rows) + " x " + std::to_string(to.columns);
        if (to.cells() > largest_cells)
            return refuse(0, 1, {"at most " + std::to_string(largest_cells) + " cells", size});
        if (!to.mask.empty() && to.mask.size() != to.cells())
            return refuse(0, 1, {"the size of the map, " + std::to_string(to.mask.size()) + " cells", size});
        for (const auto& [key, value] : to.header)
            if (key == "FRAMES")
                to.frames = whole_number(value);
    }

    /// Warns of control characters. Letters beyond ASCII may be a name in any encoding.
    static void look_for_control(std::string_view text, std::size_t byte, std::size_t line,
                                 decoding_warnings& warnings) noexcept {
        for (std::size_t i = 0; i < text.size(); ++i) {
            const auto letter = static_cast<unsigned char>(text[i]);
            if ((letter < 0x20 && letter != '\t') || letter == 0x7F)
                warnings.add({byte + i, line, 0, warning_text("text"),
                              warning_text("a control character, ", unsigned{letter})});
        }
    }

    void refuse(std::size_t byte, std::size_t line, tekscan_problem problem) {
        problem_ = {byte, line, 0, std::move(problem.expected), std::move(problem.found)};
    }

    std::string text_; ///< until it is read
    bool complete_ = false;
    std::optional<decoding_error> problem_;
};

}} // namespace tactnet
