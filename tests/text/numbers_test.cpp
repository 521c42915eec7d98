#include <tactnet/text/numbers.hpp>

#include <doctest/doctest.h>

#include <clocale>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

using tactnet::fixed_number;
using tactnet::shortest_number;

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

TEST_CASE("read_floating_point: text that is no number, or too large, has no end") {
    for (const std::string_view text : {"", ".", "x", "e5", " 1", "+1", "1e999"}) {
        CAPTURE(text);
        CHECK(tactnet::read_floating_point<double>(text.data(), text.data() + text.size()).end == nullptr);
    }
}

TEST_CASE("numbers: as few letters as read as the same number again") {
    CHECK(shortest_number(0.1) == "0.1");
    CHECK(shortest_number(0.1F) == "0.1");
    CHECK(shortest_number(1.0 / 255) == "0.00392156862745098");
    CHECK(shortest_number(1e-5) == "1e-05");
    CHECK(shortest_number(123456.0) == "123456");
    CHECK(shortest_number(-2.5) == "-2.5");
    CHECK(shortest_number(1e22) == "1e+22");
    CHECK(fixed_number(0.0) == "0");
    CHECK(fixed_number(1e-5) == "0.00001");
    CHECK(fixed_number(-0.25F) == "-0.25");
    CHECK(fixed_number(9007199254740993.0) == "9007199254740992");
}

namespace {

/// As where the standard library has no function for it.
template <class T>
std::string printed(const char* format, T value) {
    char text[tactnet::number_letters];
    return {text, tactnet::detail::print_shortest(text, text + sizeof(text), format, value)};
}

} // namespace

TEST_CASE("numbers: without the standard library's function the same letters") {
    std::uint64_t state = 7;
    for (int i = 0; i < 500; ++i) {
        state = state * 6364136223846793005U + 1442695040888963407U;
        const double value = static_cast<double>(state >> 11) / static_cast<double>(1ULL << (state % 60));
        CAPTURE(value);
        if (value < 1e16)
            CHECK(printed("%.*f", value) == fixed_number(value));
        const auto single = static_cast<float>(value);
        const std::string fixed = printed("%.*f", single), scientific = printed("%.*e", single);
        if (single < 1e7F) // of larger ones the standard library counts letters otherwise
            CHECK((fixed.size() <= scientific.size() ? fixed : scientific) == shortest_number(single));
    }
    CHECK(printed("%.*f", -0.25) == "-0.25");
    CHECK(printed("%.*e", 1e-5F) == "1e-05");
    CHECK(printed("%.*f", std::numeric_limits<double>::denorm_min()).size() == 326);
}

TEST_CASE("numbers: the point is a point in every locale, and what does not fit is not written") {
    const char* const before = std::setlocale(LC_NUMERIC, nullptr);
    const std::string kept = before == nullptr ? "C" : before;
    for (const char* const name : {"C", "de_DE.UTF-8", "fr_FR.UTF-8"})
        if (std::setlocale(LC_NUMERIC, name) != nullptr)
            CHECK(printed("%.*f", 1.5) == "1.5");
    std::setlocale(LC_NUMERIC, kept.c_str());
    char little[4];
    CHECK(tactnet::write_shortest(little, little + sizeof(little), 0.125) == little);
    CHECK(tactnet::detail::print_shortest(little, little + sizeof(little), "%.*f", 0.125) == little);
    CHECK(tactnet::write_shortest(little, little + sizeof(little), 0.5) == little + 3);
}
