#include <tactnet/io/write_number.hpp>

#include <doctest/doctest.h>

#include <clocale>
#include <cstdint>
#include <limits>
#include <string>

using tactnet::fixed_number;
using tactnet::shortest_number;

TEST_CASE("write_number: as few letters as read as the same number again") {
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
std::string in_form(const char* form, T value) {
    char text[tactnet::number_letters];
    return {text, tactnet::detail::write_in_form(text, text + sizeof(text), form, value)};
}

} // namespace

TEST_CASE("write_number: without the standard library's function the same letters") {
    std::uint64_t state = 7;
    for (int i = 0; i < 500; ++i) {
        state = state * 6364136223846793005U + 1442695040888963407U;
        const double value = static_cast<double>(state >> 11) / static_cast<double>(1ULL << (state % 60));
        CAPTURE(value);
        if (value < 1e16)
            CHECK(in_form("%.*f", value) == fixed_number(value));
        const auto single = static_cast<float>(value);
        const std::string fixed = in_form("%.*f", single), scientific = in_form("%.*e", single);
        if (single < 1e7F) // of larger ones the standard library counts letters otherwise
            CHECK((fixed.size() <= scientific.size() ? fixed : scientific) == shortest_number(single));
    }
    CHECK(in_form("%.*f", -0.25) == "-0.25");
    CHECK(in_form("%.*e", 1e-5F) == "1e-05");
    CHECK(in_form("%.*f", std::numeric_limits<double>::denorm_min()).size() == 326);
}

TEST_CASE("write_number: the point is a point in every locale, and what does not fit is not written") {
    const char* const before = std::setlocale(LC_NUMERIC, nullptr);
    const std::string kept = before == nullptr ? "C" : before;
    for (const char* const name : {"C", "de_DE.UTF-8", "fr_FR.UTF-8"})
        if (std::setlocale(LC_NUMERIC, name) != nullptr)
            CHECK(in_form("%.*f", 1.5) == "1.5");
    std::setlocale(LC_NUMERIC, kept.c_str());
    char little[4];
    CHECK(tactnet::write_shortest(little, little + sizeof(little), 0.125) == little);
    CHECK(tactnet::detail::write_in_form(little, little + sizeof(little), "%.*f", 0.125) == little);
    CHECK(tactnet::write_shortest(little, little + sizeof(little), 0.5) == little + 3);
}
