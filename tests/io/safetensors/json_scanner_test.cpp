#include <tactnet/io/safetensors/json_scanner.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

using tactnet::file_error;
using tactnet::json_scanner;

namespace {

json_scanner scan(std::string_view text) {
    return json_scanner(text, "file", 100);
}

std::string string_of(std::string_view text) {
    auto scanner = scan(text);
    std::string value = scanner.string();
    scanner.end();
    return value;
}

std::uint64_t number_of(std::string_view text) {
    auto scanner = scan(text);
    const std::uint64_t value = scanner.unsigned_integer();
    scanner.end();
    return value;
}

void skip(std::string_view text, int depth = 16) {
    auto scanner = scan(text);
    scanner.skip_value(depth);
    scanner.end();
}

} // namespace

TEST_CASE("json_scanner: strings and their escapes") {
    CHECK(string_of(R"(  "plain" )") == "plain");
    CHECK(string_of(R"("")").empty());
    CHECK(string_of(R"("\"\\\/\b\f\n\r\t")") == "\"\\/\b\f\n\r\t");
    CHECK(string_of(R"("\u0041\u00e9\u20AC\uD83D\uDE00")") == "A\xC3\xA9\xE2\x82\xAC\xF0\x9F\x98\x80");
    CHECK(string_of(R"("\u0000x")") == std::string("\0x", 2));
    CHECK(string_of("\"\xC3\xA9\"") == "\xC3\xA9");

    for (const char* wrong : {"", "x", "\"", "\"a", R"("\x")", R"("\)", R"("\u12")", R"("\u12g4")",
                              R"("\uD800")", R"("\uD800\n")", R"("\uD800\u0041")", R"("\uDC00")", "\"\n\"",
                              "\"\x1F\"", "\"\xFF\"", "\"\xC3\"", "\"a\" b"}) {
        CAPTURE(wrong);
        CHECK_THROWS_AS(string_of(wrong), file_error);
    }
}

TEST_CASE("json_scanner: whole numbers up to 2^64 - 1") {
    CHECK(number_of("0") == 0);
    CHECK(number_of(" 42\n") == 42);
    CHECK(number_of("18446744073709551615") == UINT64_MAX);
    for (const char* wrong : {"", "-1", "+1", "1.0", "1e3", "1E3", "01", "00", "18446744073709551616",
                              "99999999999999999999999", "0x10", "\"1\"", "1 2"}) {
        CAPTURE(wrong);
        CHECK_THROWS_AS(number_of(wrong), file_error);
    }
}

TEST_CASE("json_scanner: objects and arrays") {
    std::string seen;
    auto scanner = scan(R"( {"a": [1, 2] , "b":[ ],"c":{}} )");
    scanner.object([&](const std::string& key) {
        seen += key;
        if (key == "c")
            scanner.object([](const std::string&) {});
        else
            scanner.array([&] { seen += std::to_string(scanner.unsigned_integer()); });
    });
    scanner.end();
    CHECK(seen == "a12bc");
}

TEST_CASE("json_scanner: any value can be passed over, if it is one") {
    for (const char* right : {"0", "-0", "-12.5e+10", "1E-2", "10.25", "true", "false", "null", "\"x\"", "[]",
                              "{}", "[[1],{\"a\":[]}]", R"({"a":{"b":null},"c":[true,false]})"}) {
        CAPTURE(right);
        CHECK_NOTHROW(skip(right));
    }
    for (const char* wrong : {"",
                              "-",
                              "1.",
                              ".5",
                              "1e",
                              "1e+",
                              "01",
                              "tru",
                              "nul",
                              "nulll",
                              "[1,]",
                              "[,]",
                              "[1 2]",
                              "{\"a\"}",
                              "{\"a\":}",
                              "{\"a\":1,}",
                              "{a:1}",
                              "[1",
                              "{",
                              "{\"a\":1",
                              "]",
                              "{\"a\":1,\"a\":2}",
                              "[{\"a\":1,\"\\u0061\":2}]"}) {
        CAPTURE(wrong);
        CHECK_THROWS_AS(skip(wrong), file_error);
    }
}

TEST_CASE("json_scanner: nesting is bounded, so that no text can exhaust the stack") {
    CHECK_NOTHROW(skip("[[[]]]", 3));
    CHECK_THROWS_AS(skip("[[[]]]", 2), file_error);
    CHECK_THROWS_AS(skip(std::string(1'000'000, '[')), file_error);
}

TEST_CASE("json_scanner: an error names its place in the file") {
    auto scanner = scan(R"({"a":1,"a":2})");
    try {
        scanner.object([&](const std::string&) { scanner.skip_value(); });
        FAIL("nothing was thrown");
    } catch (const file_error& error) {
        CHECK(error.file() == "file");
        CHECK(error.place() == "header, byte 107");
        CHECK(error.expected() == "each key once");
        CHECK(error.found() == "'a' again");
        CHECK(std::string(error.what()) == "file: header, byte 107: expected each key once, found 'a' again");
    }
}
