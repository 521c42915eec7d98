#include <tactnet/text/message.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>

TEST_CASE("quoting: well-formed UTF-8, as the Unicode standard's table has it") {
    using tactnet::is_utf8;
    CHECK(is_utf8(""));
    CHECK(is_utf8("plain"));
    CHECK(is_utf8("\xC3\xA9"));         // U+00E9
    CHECK(is_utf8("\xE0\xA0\x80"));     // U+0800, the first of three bytes
    CHECK(is_utf8("\xED\x9F\xBF"));     // U+D7FF, the last before the surrogates
    CHECK(is_utf8("\xEE\x80\x80"));     // U+E000, the first behind them
    CHECK(is_utf8("\xF0\x90\x80\x80")); // U+10000
    CHECK(is_utf8("\xF4\x8F\xBF\xBF")); // U+10FFFF

    CHECK_FALSE(is_utf8("\x80"));
    CHECK_FALSE(is_utf8("\xC0\x80"));         // overlong
    CHECK_FALSE(is_utf8("\xC1\xBF"));         // overlong
    CHECK_FALSE(is_utf8("\xE0\x9F\xBF"));     // overlong
    CHECK_FALSE(is_utf8("\xF0\x8F\xBF\xBF")); // overlong
    CHECK_FALSE(is_utf8("\xED\xA0\x80"));     // a surrogate
    CHECK_FALSE(is_utf8("\xF4\x90\x80\x80")); // above U+10FFFF
    CHECK_FALSE(is_utf8("\xF5\x80\x80\x80"));
    CHECK_FALSE(is_utf8("\xE2\x28\x80")); // each byte behind the first must continue it
    CHECK_FALSE(is_utf8("\xE2\x82\x28"));
    CHECK_FALSE(is_utf8("\xF0\x9F\x28\x80"));
    CHECK_FALSE(is_utf8("\xF0\x9F\x98\x28"));
    CHECK_FALSE(is_utf8("\xC3"));
    CHECK_FALSE(is_utf8("\xE2\x82"));
    CHECK_FALSE(is_utf8("\xF0\x9F\x98"));
    CHECK_FALSE(is_utf8("a\xC3z"));
    CHECK_FALSE(is_utf8("\xFF"));
}

TEST_CASE("quoting: a name is printable if a terminal shows it and does nothing else") {
    using tactnet::is_printable;
    for (const std::string_view name : {"", "plain name", "Schl\xC3\xBCssel", "\xE9\x8D\xB5",
                                        "\xF0\x9F\x94\x91", "\xC2\xA0", "\xE2\x80\xA6", "\xE2\x81\xAA"})
        CHECK(is_printable(name));
    for (const std::string_view name :
         {"a\nb", "\t", "\x1B[2J", "\x7F", "\xC2\x80", "\xC2\x9F", "\xD8\x9C", "\xE2\x80\x8E", "\xE2\x80\xA8",
          "\xE2\x80\xAE", "\xE2\x81\xA6", "\xE2\x81\xA9", "\xFF"}) {
        CHECK(!is_printable(name));
        CHECK(is_printable(tactnet::in_quotes(name)));
    }
    CHECK(!is_printable(std::string_view("\0", 1)));
    CHECK(tactnet::in_quotes("\xC2\x9B"
                             "2J") == "'\\xc2\\x9b2J'");
}

TEST_CASE("quoting: every character there is, and none with a byte less or of the wrong kind") {
    std::size_t wrong = 0;
    std::string text;
    for (std::uint32_t code = 0; code <= 0x10FFFF; ++code) {
        text.clear();
        tactnet::detail::append_utf8(text, code);
        const bool surrogate = code >= 0xD800 && code <= 0xDFFF;
        wrong += tactnet::utf8_sequence_length(text) != (surrogate ? 0 : text.size());
        if (code < 0x80)
            continue;
        wrong += tactnet::utf8_sequence_length(std::string_view(text).substr(0, text.size() - 1)) != 0;
        for (const char no_continuation : {'\x7F', '\xC0'}) {
            text.back() = no_continuation;
            wrong += tactnet::utf8_sequence_length(text) != 0;
        }
    }
    CHECK(wrong == 0);
}

TEST_CASE("quoting: as a JSON string") {
    using namespace std::string_view_literals;
    using tactnet::json_string;
    CHECK(json_string("") == "\"\"");
    CHECK(json_string("a \"b\" \\ \xC3\xA9") == "\"a \\\"b\\\" \\\\ \xC3\xA9\"");
    CHECK(json_string("a\n\x1F\0"sv) == "\"a\\u000a\\u001f\\u0000\"");
    CHECK_THROWS_AS(static_cast<void>(json_string("\xC3")), std::invalid_argument);
}

TEST_CASE("quoting: names in messages cannot break the line or the terminal") {
    using namespace std::string_view_literals;
    using tactnet::in_quotes;
    CHECK(in_quotes("conv1.weight") == "'conv1.weight'");
    CHECK(in_quotes("a b~\x1F") == "'a b~\\x1f'");
    CHECK(in_quotes("a\nb\x1B[2J\x7F") == "'a\\x0ab\\x1b[2J\\x7f'");
    CHECK(in_quotes("a\0b"sv) == "'a\\x00b'");
    CHECK(in_quotes("\xC3\xA9\xC3") == "'\xC3\xA9\\xc3'");
    CHECK(in_quotes(std::string(200, 'x'), 10) == "'xxxxxxxxxx\u2026'");
    CHECK(in_quotes(std::string(10, 'x'), 10) == "'xxxxxxxxxx'");
    // A character is never cut in half.
    CHECK(in_quotes("\xC3\xA9\xC3\xA9", 1) == "'\xC3\xA9\u2026'");
}
