#include <tactnet/kernels/simd/row_vector.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

template <std::size_t Lanes>
using width = constant<Lanes>;

template <class Vector>
inline constexpr std::size_t size_of = sizeof(Vector) / sizeof(float);

/// begin, begin + 1 … without alignment.
template <class Vector>
Vector counting(float begin) {
    std::array<float, size_of<Vector> + 1> values;
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = begin + static_cast<float>(i) - 1;
    return load_unaligned<Vector>(values.data() + 1);
}
template <class Vector>
std::array<float, size_of<Vector>> elements(const Vector& v) {
    std::array<float, size_of<Vector> + 1> values;
    store_anywhere(values.data() + 1, v);
    std::array<float, size_of<Vector>> result;
    for (std::size_t i = 0; i < result.size(); ++i)
        result[i] = values[i + 1];
    return result;
}

} // namespace

TEST_CASE_TEMPLATE("row_vector: every operation, lane by lane", Width, width<lanes<float>>,
                   width<min_lanes<float>>) {
    constexpr std::size_t n = Width::value;
    using wide = sized_vector<float, n>;
    constexpr float infinity = std::numeric_limits<float>::infinity(),
                    not_a_number = std::numeric_limits<float>::quiet_NaN();
    const wide a = counting<wide>(-2.25f);
    const auto kept = elements(clamp(a, wide(-1.5f), wide(0.5f))), whole = elements(truncate(a)),
               zeros = elements(select_if_zero(counting<wide>(-1), wide(7), a));
    std::array<std::int32_t, n + 1> numbers{};
    store_int32(numbers.data() + 1, a);
    std::array<std::uint8_t, n + 1> bytes;
    for (std::size_t i = 0; i <= n; ++i)
        bytes[i] = static_cast<std::uint8_t>(256 - i);
    const auto of_bytes = elements(load_floats<wide>(bytes.data() + 1));
    for (std::size_t i = 0; i < n; ++i) {
        CHECK(of_bytes[i] == 255 - static_cast<float>(i));
        const float value = -2.25f + static_cast<float>(i);
        CHECK(elements(a)[i] == value);
        CHECK(kept[i] == std::fmin(std::fmax(value, -1.5f), 0.5f));
        CHECK(whole[i] == std::trunc(value));
        CHECK(numbers[i + 1] == static_cast<std::int32_t>(value));
        CHECK(zeros[i] == (i == 1 ? 7 : value));
    }
    CHECK(elements(clamp(wide(not_a_number), wide(1), wide(2)))[0] == 1);
    CHECK(elements(clamp(wide(infinity), wide(1), wide(2)))[0] == 2);
    CHECK(all_finite(a));
    for (const float broken : {infinity, -infinity, not_a_number}) {
        std::array<float, n> values{};
        values[n - 1] = broken;
        CHECK_FALSE(all_finite(load_unaligned<wide>(values.data())));
    }
}

TEST_CASE_TEMPLATE("row_vector: interleave, deinterleave and spread", Width, width<lanes<float>>,
                   width<min_lanes<float>>) {
    constexpr std::size_t n = Width::value;
    using wide = sized_vector<float, n>;
    std::array<wide, 8> sequence;
    for (std::size_t v = 0; v < 8; ++v)
        sequence[v] = counting<wide>(static_cast<float>(v * n));
    const auto eight = deinterleave(sequence);
    const auto two = deinterleave(std::array{sequence[0], sequence[1]});
    const auto both = interleave(sequence[0], sequence[1]);
    const auto three = repeat_three(sequence[1]);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t way = 0; way < 8; ++way)
            CHECK(elements(eight[way])[i] == static_cast<float>(8 * i + way));
        for (std::size_t way = 0; way < 2; ++way) {
            CHECK(elements(two[way])[i] == static_cast<float>(2 * i + way));
            const std::size_t place = way * n + i;
            CHECK(elements(both[way])[i] == static_cast<float>(place / 2 + place % 2 * n));
        }
        for (std::size_t part = 0; part < 3; ++part)
            CHECK(elements(three[part])[i] == static_cast<float>(n + (part * n + i) / 3));
    }
}

TEST_CASE("row_vector: cover a row, and nothing beyond it where it is long enough") {
    for (const std::size_t width : {1u, 4u, 8u, 16u})
        for (std::size_t count = 1; count < 60; ++count) {
            std::size_t covered = 0;
            for (std::size_t v = 0; v < row_vectors(count, width); ++v) {
                const std::size_t begin = row_vector_begin(v, count, width);
                CHECK(begin <= covered);
                CHECK((begin + width <= count || count < width));
                covered = begin + width;
            }
            CHECK(covered >= count);
        }
    CHECK(row_lanes<float>(1) == min_lanes<float>);
    CHECK(row_lanes<float>(16 * lanes<float>) == lanes<float>);
}

TEST_CASE("store_in_row: no more than the row holds") {
    std::array<float, 3 + 4> row;
    row.fill(-1);
    using wide = sized_vector<float, min_lanes<float>>;
    constexpr std::size_t count = min_lanes<float> == 1 ? 1 : 3;
    store_in_row<count, min_lanes<float>>(row.data(), counting<wide>(5));
    for (std::size_t i = 0; i < row.size(); ++i)
        CHECK(row[i] == (i < count ? 5 + static_cast<float>(i) : -1));
}
