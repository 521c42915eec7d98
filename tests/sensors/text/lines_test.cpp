#include <tactnet/sensors/text/lines.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

using namespace tactnet;

namespace {

std::span<const std::byte> bytes_of(std::string_view text) {
    return std::as_bytes(std::span(text));
}

struct taken_line {
    std::string text;
    std::size_t byte, number;
    bool ended;
    friend bool operator==(const taken_line&, const taken_line&) = default;
};
/// The lines of a text that comes in pieces of so many bytes.
std::vector<taken_line> lines_of(std::string_view text, std::size_t piece) {
    line_splitter splitter;
    std::vector<taken_line> lines;
    const auto take = [&](const text_line& line) {
        lines.push_back({std::string(line.text), line.byte, line.number, line.ended});
        return true;
    };
    for (std::size_t at = 0; at < text.size(); at += piece)
        CHECK(splitter.push(bytes_of(text.substr(at, piece)), take));
    splitter.finish(take);
    return lines;
}

} // namespace

TEST_CASE("line_splitter: the same lines however the text is cut, with LF, CR LF and a byte order mark") {
    constexpr std::string_view text = "\xEF\xBB\xBF"
                                      "one\r\ntwo\n\nfour\r\r\nlast";
    const std::vector<taken_line> expected{{"one", 0, 1, true},
                                           {"two", 8, 2, true},
                                           {"", 12, 3, true},
                                           {"four", 13, 4, true},
                                           {"last", 20, 5, false}};
    for (std::size_t piece = 1; piece <= text.size(); ++piece) {
        CAPTURE(piece);
        CHECK(lines_of(text, piece) == expected);
    }
}

TEST_CASE(
    "line_splitter: a line that has not ended is no reason to stop; the taker's word and a long line are") {
    line_splitter splitter;
    std::vector<std::string> lines;
    const auto until_stop = [&](const text_line& line) {
        lines.emplace_back(line.text);
        return line.text != "stop";
    };
    CHECK(splitter.push(bytes_of("begun"), until_stop));
    CHECK(lines.empty());
    CHECK(splitter.number() == 1);
    CHECK(splitter.push(bytes_of(" and ended\nanother"), until_stop));
    CHECK(lines == std::vector<std::string>{"begun and ended"});
    CHECK(splitter.byte() == 16);
    CHECK(splitter.number() == 2);
    CHECK_FALSE(splitter.push(bytes_of("\nstop\nnever seen\n"), until_stop));
    CHECK(lines == std::vector<std::string>{"begun and ended", "another", "stop"});
    CHECK_FALSE(splitter.too_long());

    line_splitter patient;
    const std::string longest(largest_header_bytes, 'x');
    CHECK(patient.push(bytes_of(longest), until_stop));
    CHECK_FALSE(patient.push(bytes_of("x"), until_stop));
    CHECK(patient.too_long());
}
