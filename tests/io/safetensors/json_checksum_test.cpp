#include <tactnet/io/safetensors/json_checksum.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <support/error_of.hpp>
#include <support/files/bit_flips.hpp>
#include <vector>

using namespace tactnet;

namespace {

std::string error_of(std::string_view json) {
    return support::error_of<file_error>([&] { static_cast<void>(check_json(json, "file", "line 3")); });
}

bool noticed(const std::vector<std::byte>& bytes) {
    return error_of({reinterpret_cast<const char*>(bytes.data()), bytes.size()}) != "no error";
}

} // namespace

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
