#pragma once

#include <tactnet/sensors/described/frame_file.hpp>
#include <tactnet/sensors/text/measures.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

// Grey images as PGM: "P5", columns, rows and the largest value as digits, then bytes, or 16 bits with the
// higher byte first. Comments from # to the end of a line may stand between them.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Decodes a binary PGM file, of one image or of several of one size.
class pgm_images : public frame_file<pgm_images> {
public:
    explicit pgm_images(const sensor_description& sensor = {}) : frame_file("PGM", sensor) {}

private:
    friend class frame_file<pgm_images>;

    std::optional<head> read_head(std::span<const std::byte> bytes, sensor_description& d) {
        const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        if (text.size() >= 2 && !text.starts_with("P5"))
            return refuse("'P5', binary grey values", text.substr(0, 2));
        std::array<std::size_t, 3> numbers{};
        std::size_t at = std::min<std::size_t>(2, text.size());
        for (std::size_t& number : numbers) {
            const std::size_t before = at;
            while (at < text.size() && (is_space(text[at]) || text[at] == '#'))
                at = text[at] == '#' ? std::min(text.find('\n', at), text.size()) : at + 1;
            const std::size_t first = at;
            for (; at < text.size() && detail::is_digit(text[at]) && at - first < 8; ++at)
                number = number * 10 + static_cast<std::size_t>(text[at] - '0');
            if (at == text.size())
                return std::nullopt;
            if (at == first || first == before || !(is_space(text[at]) || text[at] == '#'))
                return refuse("columns, rows and the largest value", text.substr(first, at + 1 - first));
        }
        const auto [columns, rows, largest] = numbers;
        if (largest == 0 || largest > 0xFFFF)
            return refuse("a largest value from 1 to 65535", std::to_string(largest));
        d.rows = rows, d.columns = columns;
        d.cell = largest < 256 ? cell_type::uint8 : cell_type::uint16;
        d.cell_bytes = byte_order::big;
        d.full_scale = d.full_scale.value_or(static_cast<double>(largest));
        return head{at + 1, 1, largest};
    }
    static bool is_space(char c) noexcept { return c == ' ' || (c >= '\t' && c <= '\r'); }
    std::nullopt_t refuse(const char* expected, std::string_view found) {
        damage({expected}, {detail::quoted{found}});
        return std::nullopt;
    }
};

}} // namespace tactnet
