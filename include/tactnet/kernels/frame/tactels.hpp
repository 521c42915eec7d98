#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/compiler_vector.hpp>
#include <tactnet/kernels/simd/unroll.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

// What is computed for every tactel of a frame of 8-bit counts before a network sees it.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Lanes of a vector of counts. Arrays of counts are padded to whole vectors.
inline constexpr std::size_t count_lanes = std::max<std::size_t>(4 * max_integer_lanes, 16);
[[nodiscard]] constexpr std::size_t whole_count_vectors(std::size_t counts) {
    return tactnet::detail::ceil_div(counts, count_lanes) * count_lanes;
}

namespace detail {

template <class T>
using count_words = typename compiler_vector<T, count_lanes / sizeof(T)>::type;

/// Adds neighbouring elements of half the width of T. Elements of bytes keep their order, so that the result
/// does not depend on the byte order.
template <class T>
[[nodiscard]] [[gnu::always_inline]] inline count_words<T> sum_halves(const count_words<T>& halves) {
    constexpr int bits = static_cast<int>(sizeof(T)) * 4;
    return (halves & static_cast<T>((T{1} << bits) - 1)) + (halves >> bits);
}
/// The sum of all lanes, of 16 bits each.
[[nodiscard]] [[gnu::always_inline]] inline std::uint32_t
sum_lanes(const count_words<std::uint16_t>& values) {
    const auto sums = sum_halves<std::uint32_t>(reinterpret_cast<count_words<std::uint32_t>>(values));
    std::uint32_t sum = 0;
    for (std::size_t lane = 0; lane < count_lanes / sizeof(std::uint32_t); ++lane)
        sum += sums[lane];
    return sum;
}
/// The sums of pairs of bytes.
[[nodiscard]] [[gnu::always_inline]] inline count_words<std::uint16_t>
sum_pairs(const uint8_vec<count_lanes>& values) {
    return sum_halves<std::uint16_t>(reinterpret_cast<count_words<std::uint16_t>>(values));
}
[[nodiscard]] [[gnu::always_inline]] inline bool any_set(const uint8_vec<count_lanes>& values) {
    const auto words = reinterpret_cast<count_words<std::uint64_t>>(values);
    std::uint64_t all = 0;
    for (std::size_t lane = 0; lane < count_lanes / sizeof(std::uint64_t); ++lane)
        all |= words[lane];
    return all != 0;
}

} // namespace detail

/// How many counts are above, and how many below, the level of their tactel.
struct level_tally {
    std::size_t above = 0, below = 0;
};

/// Subtracts its level, plus an offset that all have in common, from each of `Size` counts; what is below
/// becomes 0. A level is at most 255.
template <std::size_t Size>
[[nodiscard]] level_tally subtract_levels(std::uint8_t* counts, const std::uint8_t* levels,
                                          std::uint8_t offset) noexcept {
    static_assert(Size % count_lanes == 0, "subtract_levels: expected whole vectors");
    using vector = uint8_vec<count_lanes>;
    level_tally tally;
    for (std::size_t first = 0; first < Size; first += 255 * count_lanes) { // a byte counts to 255
        vector above{}, below{};
        for (std::size_t i = first; i < std::min(first + 255 * count_lanes, Size); i += count_lanes) {
            const auto count = load_bytes_as<vector>(counts + i), own = load_bytes_as<vector>(levels + i);
            const vector sum = own + offset;
            const vector level = sum | reinterpret_cast<vector>(sum < own);
            const auto is_above = reinterpret_cast<vector>(count > level);
            store_any(counts + i, vector((count - level) & is_above));
            above -= is_above;
            below -= reinterpret_cast<vector>(count < level);
        }
        tally.above += detail::sum_lanes(detail::sum_pairs(above));
        tally.below += detail::sum_lanes(detail::sum_pairs(below));
    }
    return tally;
}

/// How many of `Size` counts are at least `pressed`, and the sum of these.
struct pressed_tally {
    std::uint32_t area = 0, force = 0;
};
template <std::size_t Size>
[[nodiscard]] pressed_tally tally_pressed(const std::uint8_t* counts, std::uint8_t pressed) noexcept {
    using vector = uint8_vec<count_lanes>;
    using words = detail::count_words<std::uint16_t>;
    constexpr std::size_t most = 128; // vectors whose sums of two counts an element of 16 bits holds
    pressed_tally tally;
    const auto take = [&](const vector& count, vector& area, words& force) {
        const auto is_pressed = reinterpret_cast<vector>(count >= pressed);
        area -= is_pressed;
        force += detail::sum_pairs(vector(count & is_pressed));
    };
    constexpr std::size_t whole = Size / count_lanes * count_lanes;
    for (std::size_t first = 0; first < Size; first += most * count_lanes) {
        vector area{};
        words force{};
        for (std::size_t i = first; i < std::min(first + most * count_lanes, whole); i += count_lanes)
            take(load_bytes_as<vector>(counts + i), area, force);
        if (whole < Size && first + most * count_lanes >= Size) {
            vector last{};
            std::memcpy(&last, counts + whole, Size - whole);
            if (pressed > 0) // or the zeros behind the last count would be pressed
                take(last, area, force);
        }
        tally.area += detail::sum_lanes(detail::sum_pairs(area));
        tally.force += detail::sum_lanes(force);
    }
    return tally;
}

/// The distances of the eight neighbours of a tactel, in rows of `Stride`, from the one above and to the
/// left.
template <std::size_t Stride>
inline constexpr std::array<std::size_t, 8> neighbour_distances{
    0, 1, 2, Stride, Stride + 2, 2 * Stride, 2 * Stride + 1, 2 * Stride + 2};

/// The limits of find_suspects: see tactnet::fault_limits.
struct sign_limits {
    std::uint8_t spike, hole, pressed, neighbours;
};
inline constexpr std::uint8_t spike_sign = 1, hole_sign = 2;

/// Compares each of `Size` tactels, in rows of `Stride`, with its eight neighbours, and writes spike_sign,
/// hole_sign or 0 to `signs`. `counts` begins at the neighbour of the first tactel that is above and to the
/// left. Returns whether any is not 0.
template <std::size_t Size, std::size_t Stride>
[[nodiscard]] bool find_suspects(const std::uint8_t* counts, const sign_limits& limits,
                                 std::uint8_t* signs) noexcept {
    static_assert(Size % count_lanes == 0, "find_suspects: expected whole vectors");
    using vector = uint8_vec<count_lanes>;
    // Of enough neighbours, at most four are corners. In most vectors the other four rule out every sign.
    const auto enough_of_four = static_cast<std::uint8_t>(limits.neighbours > 4 ? limits.neighbours - 4 : 0);
    vector any{};
    for (std::size_t i = 0; i < Size; i += count_lanes) {
        const auto own = load_bytes_as<vector>(counts + i + Stride + 1);
        const vector eighth = own >> 3;
        const auto is_high = reinterpret_cast<vector>(own >= limits.spike);
        const auto is_low = reinterpret_cast<vector>(own <= limits.hole);
        vector low{}, pressed{};
        const auto count_four = [&](const std::array<std::size_t, 4>& neighbours) {
            unroll<4>([&](auto n) {
                const auto neighbour =
                    load_bytes_as<vector>(counts + i + neighbour_distances<Stride>[neighbours[n]]);
                low -= reinterpret_cast<vector>(neighbour < eighth);
                pressed -= reinterpret_cast<vector>(neighbour >= limits.pressed);
            });
        };
        const auto signs_from = [&](std::uint8_t enough) -> vector {
            return (is_high & reinterpret_cast<vector>(low >= enough) & spike_sign) |
                   (is_low & reinterpret_cast<vector>(pressed >= enough) & hole_sign);
        };
        count_four({1, 3, 4, 6}); // above, left, right, below
        vector sign = signs_from(enough_of_four);
        if (detail::any_set(sign)) {
            count_four({0, 2, 5, 7});
            sign = signs_from(limits.neighbours);
        }
        store_any(signs + i, sign);
        any |= sign;
    }
    std::uint8_t found = 0;
    for (std::size_t lane = 0; lane < count_lanes; ++lane)
        found = static_cast<std::uint8_t>(found | any[lane]);
    return found != 0;
}

}}} // namespace tactnet::kernels
