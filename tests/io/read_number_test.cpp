#include <tactnet/io/read_number.hpp>

#include <doctest/doctest.h>

#include <limits>
#include <string_view>

namespace {

template <class T>
void reads(std::string_view text, T value, std::size_t length) {
    CAPTURE(text);
    const auto found = tactnet::read_floating_point<T>(text.data(), text.data() + text.size());
    REQUIRE(found.end != nullptr);
    CHECK(found.value == value);
    CHECK(found.end - text.data() == static_cast<std::ptrdiff_t>(length));
}

} // namespace

TEST_CASE("read_floating_point: the number that a text begins with, rounded once, and where it ends") {
    reads("0.1", 0.1, 3);
    reads("7", 7.0, 1);
    reads("12.", 12.0, 3);
    reads(".5", 0.5, 2);
    reads("1e3;", 1000.0, 3);
    reads("2E-3 kPa", 0.002, 4);
    reads("3e", 3.0, 1);
    reads("3e+x", 3.0, 1);
    reads("4.5f", 4.5, 3);
    reads("9007199254740993", 9007199254740992.0, 16);
    reads("2.2250738585072014e-308", std::numeric_limits<double>::min(), 23);
    reads("0.003921569", 0.003921569F, 11);
    reads("16777217", 16777216.0F, 8);
}

TEST_CASE("read_floating_point: what is no number, or too large, has no end") {
    for (const std::string_view text : {"", ".", "x", "e5", " 1", "+1", "1e999"}) {
        CAPTURE(text);
        CHECK(tactnet::read_floating_point<double>(text.data(), text.data() + text.size()).end == nullptr);
    }
}
