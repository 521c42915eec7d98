#include <tactnet/io/safetensors/format.hpp>
#include <tactnet/io/safetensors/json_checksum.hpp>
#include <tactnet/io/safetensors/json_scanner.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <support/error_of.hpp>
#include <support/files/bit_flips.hpp>
#include <vector>

namespace {

using namespace tactnet;
using tactnet::file_error;
using tactnet::json_scanner;

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
    std::istringstream all_wrong(
        R"(|-|1.|.5|1e|1e+|01|tru|nul|nulll|[1,]|[,]|[1 2]|{"a"}|{"a":}|{"a":1,}|{a:1}|[1|{|{"a":1|]|)"
        R"({"a":1,"a":2}|[{"a":1,"\u0061":2}])");
    for (std::string wrong; std::getline(all_wrong, wrong, '|');) {
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

std::string error_of(std::string_view json) {
    return support::error_of<file_error>([&] { static_cast<void>(check_json(json, "file", "line 3")); });
}

bool noticed(const std::vector<std::byte>& bytes) {
    return error_of({reinterpret_cast<const char*>(bytes.data()), bytes.size()}) != "no error";
}

TEST_CASE("json_checksum: put in and taken out") {
    // The checksums are from another implementation of XXH64.
    CHECK(with_checksum(R"({"a":1})") == R"({"a":1,"checksum":"tactnet-xxh64:951017e31ca3fe64"})");
    CHECK(with_checksum("{}\n") == "{\"checksum\":\"tactnet-xxh64:d28d338fc376b058\"}\n");
    for (const std::string json :
         {"{}", "{ }\n", R"({"a":1})", "{\n    \"a\": [1.5e-3, {\"b\": \"\xC3\xA9\"}]\n}\n",
          R"({"a":{"checksum":1}})"}) {
        const std::string with = with_checksum(json);
        CAPTURE(with);
        CHECK(with.size() > json.size());
        const checked_json back = check_json(with, "file");
        CHECK(back.text == json);
        CHECK(back.checksum == checksum_state::verified);
        const checked_json without = check_json(json, "file");
        CHECK(without.text == json);
        CHECK(without.checksum == checksum_state::absent);
    }
    for (const std::string_view none : {"", " ", "{", "}", "[1]", "1", " {}"})
        CHECK_THROWS_AS(static_cast<void>(with_checksum(none)), std::invalid_argument);
    CHECK_THROWS_AS(static_cast<void>(with_checksum(with_checksum("{}"))), std::invalid_argument);
}

TEST_CASE("json_checksum: no single bit of a line changes unnoticed") {
    for (const std::string_view json :
         {R"({"settings":{"seed":"3","network":"tactnet4"},"accuracy":0.9375,"confusion":[12,0,1,9]})", "{}",
          "{\n    \"scene\": \"plain\"\n}\n"}) {
        const std::string line = with_checksum(json);
        const auto bytes = std::as_bytes(std::span(line));
        REQUIRE_FALSE(noticed({bytes.begin(), bytes.end()}));
        CHECK(support::unnoticed_flips({bytes.begin(), bytes.end()}, noticed) == std::vector<std::size_t>{});
    }
}

TEST_CASE("json_checksum: two lines that have become one, or one that has become two") {
    const std::string line = with_checksum(R"({"a":1})");
    CHECK(error_of(line + "\v" + line) != "no error");
    CHECK(error_of(line + " " + line) != "no error");
    for (std::size_t cut = 1; cut < line.size(); ++cut) {
        CHECK(error_of(line.substr(0, cut)) != "no error");
        CHECK(error_of(line.substr(cut)) != "no error");
    }
}

TEST_CASE("json_checksum: errors say where and what") {
    CHECK(
        error_of(R"({"a":2,"checksum":"tactnet-xxh64:951017e31ca3fe64"})")
            .starts_with("file: checksum of the line 3: expected tactnet-xxh64:951017e31ca3fe64, as when it "
                         "was written, found tactnet-xxh64:"));
    CHECK(error_of(R"({"checksum":"tactnet-xxh64:951017e31ca3fe64","a":1})") ==
          "file: line 3: expected a checksum as the last member, found one that is damaged");
    CHECK(error_of(R"({"a":1,"checksum":"mine"})") ==
          "file: line 3: expected a checksum as the last member, found one that is damaged");
    CHECK(error_of(R"({"a":1)") == "file: line 3, byte 6: expected '}', found the end of the line 3");
    CHECK(error_of(R"({"a":1,"a":1})") == "file: line 3, byte 7: expected each key once, found 'a' again");
}

TEST_CASE("json_checksum: a hundred thousand brackets are refused, not recursed into") {
    for (const char* open : {"[", "{\"a\":"}) {
        std::string deep;
        for (int i = 0; i < 100'000; ++i)
            deep += open;
        CHECK(error_of(deep).find("expected less nesting") != std::string::npos);
    }
    CHECK(error_of(std::string(100'000, '[') + std::string(100'000, ']')).find("expected less nesting") !=
          std::string::npos);
}

/// The bytes that xxHash's own program checks itself with (xxhsum.c of version 0.8.1).
std::vector<std::byte> sanity_bytes(std::size_t count) {
    std::vector<std::byte> bytes;
    std::uint64_t generator = 2654435761;
    for (std::size_t i = 0; i < count; ++i, generator *= 11400714785074694797U)
        bytes.push_back(static_cast<std::byte>(generator >> 56));
    return bytes;
}

TEST_CASE("checksum: XXH64's published values") {
    struct {
        std::size_t length;
        std::uint64_t plain, seeded;
    } const published[] = {
        {0, 0xEF46DB3751D8E999, 0xAC75FDA2929B17EF},   {1, 0xE934A84ADB052768, 0x5014607643A9B4C3},
        {4, 0x9136A0DCA57457EE, 0xCAAB286BD8E9FDB5},   {14, 0x8282DCC4994E35C8, 0xC3BD6BF63DEB6DF0},
        {222, 0xB641AE8CB691C174, 0x20CB8AB7AE10C14A},
    };
    for (const auto& row : published) {
        CAPTURE(row.length);
        const std::vector<std::byte> bytes = sanity_bytes(row.length);
        CHECK(xxh64().update(bytes).digest() == row.plain);
        CHECK(xxh64(2654435761).update(bytes).digest() == row.seeded);
    }
    CHECK(xxh64().update("a").digest() == 0xD24EC4F1A98C6E5B);
    CHECK(xxh64().update("abc").digest() == 0x44BC2CF5AD770999);
}

TEST_CASE("checksum: the same in pieces of any size") {
    const std::vector<std::byte> bytes = sanity_bytes(222);
    for (std::size_t size = 1; size < 100; ++size) {
        xxh64 sum;
        for (std::size_t at = 0; at < bytes.size(); at += size)
            sum.update(std::span(bytes).subspan(at, std::min(size, bytes.size() - at)));
        CHECK(sum.digest() == 0xB641AE8CB691C174);
    }
}

TEST_CASE("checksum: as text and back, and no other text") {
    CHECK(checksum_text(0) == "tactnet-xxh64:0000000000000000");
    CHECK(checksum_text(0xEF46DB3751D8E999) == "tactnet-xxh64:ef46db3751d8e999");
    CHECK(parse_checksum("tactnet-xxh64:ef46db3751d8e999") == 0xEF46DB3751D8E999);
    for (const std::string_view wrong :
         {"", "tactnet-xxh64:", "tactnet-xxh64:ef46db3751d8e99", "tactnet-xxh64:ef46db3751d8e9999",
          "tactnet-xxh64:EF46DB3751D8E999", "tactnet-xxh64:ef46db3751d8e99g",
          "tactnet-xxh32:ef46db3751d8e999", "tactnet-xxh64: f46db3751d8e999"})
        CHECK_FALSE(parse_checksum(wrong));
}

TEST_CASE("checksum: of text around its own digits") {
    std::string text = "before " + checksum_text(0) + " behind";
    const std::size_t place = 7 + checksum_mark.size();
    const std::uint64_t sum = xxh64().update(text).digest();
    const auto around = [&] { return checksum_around(std::as_bytes(std::span(text)), place); };
    CHECK(around() == sum);
    text.replace(7, checksum_mark.size() + checksum_digits, checksum_text(sum));
    CHECK(around() == sum);
    text.back() = 'D';
    CHECK(around() != sum);
}

} // namespace
