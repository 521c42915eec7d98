#include <tactnet/io/safetensors/element_type.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>

using tactnet::element_type;

static_assert(tactnet::element_size(element_type::boolean) == 1);
static_assert(tactnet::element_size(element_type::bfloat16) == 2);
static_assert(tactnet::element_size(element_type::float64) == 8);
static_assert(tactnet::element_type_of<float>() == element_type::float32);
static_assert(tactnet::element_type_of<double>() == element_type::float64);
static_assert(tactnet::element_type_of<std::uint8_t>() == element_type::uint8);
static_assert(tactnet::element_type_of<std::int16_t>() == element_type::int16);
static_assert(tactnet::element_type_of<std::uint32_t>() == element_type::uint32);
static_assert(tactnet::element_type_of<std::int64_t>() == element_type::int64);
static_assert(!tactnet::storable<bool> && !tactnet::storable<long double>);

TEST_CASE("element_type: each type is found by its own name") {
    for (const auto& row : tactnet::detail::element_type_table) {
        CHECK(tactnet::find_element_type(row.name) == row.type);
        CHECK(tactnet::element_type_name(row.type) == row.name);
        CHECK(tactnet::element_size(row.type) == row.size);
    }
    CHECK_FALSE(tactnet::find_element_type("f32"));
    CHECK_FALSE(tactnet::find_element_type(""));
    CHECK_FALSE(tactnet::find_element_type("F8_E4M3"));
}

TEST_CASE("element_type: float16: all 65536 numbers against the definition") {
    for (std::uint32_t bits = 0; bits < 65536; ++bits) {
        const double sign = (bits & 0x8000U) != 0 ? -1 : 1;
        const int exponent = static_cast<int>((bits >> 10) & 31U);
        const int fraction = static_cast<int>(bits & 1023U);
        const float value = tactnet::float16_to_float(static_cast<std::uint16_t>(bits));
        if (exponent == 31 && fraction != 0) {
            REQUIRE(std::isnan(value));
            continue;
        }
        const double expected = exponent == 31  ? INFINITY
                                : exponent == 0 ? std::ldexp(fraction, -24)
                                                : std::ldexp(1024 + fraction, exponent - 25);
        REQUIRE(static_cast<double>(value) == sign * expected);
        REQUIRE(std::signbit(value) == (sign < 0));
    }
}

TEST_CASE("element_type: bfloat16") {
    CHECK(tactnet::bfloat16_to_float(0x3F80) == 1.0F);
    CHECK(tactnet::bfloat16_to_float(0xC049) == -3.140625F);
    CHECK(tactnet::bfloat16_to_float(0x0001) == std::ldexp(1.0F, -133));
    CHECK(std::isinf(tactnet::bfloat16_to_float(0x7F80)));
    CHECK(std::isnan(tactnet::bfloat16_to_float(0x7FC0)));
}
