#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/selected.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

// What is computed for every tactel of a frame before a network sees it: of 8-bit counts, or of deeper counts
// in 1/256 of these, as 16 bits.

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
template <class Vector>
[[nodiscard]] [[gnu::always_inline]] inline bool any_set(const Vector& values) {
    const auto words = reinterpret_cast<count_words<std::uint64_t>>(values);
    std::uint64_t all = 0;
    for (std::size_t lane = 0; lane < count_lanes / sizeof(std::uint64_t); ++lane)
        all |= words[lane];
    return all != 0;
}

} // namespace detail

/// How many counts are at most, and how many below, the level of their tactel.
struct level_tally {
    std::size_t at_most = 0, below = 0;
};

/// Writes each of `Size` counts less its level, which is raised by an offset to at most 255; 0 for counts
/// below it. `levels` and `to` have whole vectors, and zeros after the last level.
template <std::size_t Size>
[[nodiscard]] level_tally subtract_levels(const std::uint8_t* counts, const std::uint8_t* levels,
                                          std::uint8_t offset, std::uint8_t* to) noexcept {
    using vector = uint8_vec<count_lanes>;
    constexpr std::size_t whole = Size / count_lanes * count_lanes, most = 255 * count_lanes,
                          padding = whole_count_vectors(Size) - Size;
    std::size_t at_most = 0, at_least = 0;
    vector zeros{}, equals{};
    const auto take = [&](const vector& count, std::size_t i) {
        const auto own = load_bytes_as<vector>(levels + i);
        const vector room = ~own, level = own + (room < offset ? room : vector{} + offset);
        const vector smaller = count < level ? count : level, above = count - smaller;
        store_any(to + i, above);
        zeros -= reinterpret_cast<vector>(above == 0);
        equals -= reinterpret_cast<vector>(smaller == level);
    };
    const auto add_up = [&] {
        at_most += detail::sum_lanes(detail::sum_pairs(zeros));
        at_least += detail::sum_lanes(detail::sum_pairs(equals));
        zeros = equals = vector{};
    };
    for (std::size_t first = 0; first < whole; first += most) { // a byte counts to 255
        for (std::size_t i = first; i < std::min(first + most, whole); i += count_lanes)
            take(load_bytes_as<vector>(counts + i), i);
        add_up();
    }
    if constexpr (padding > 0) {
        vector last{};
        std::memcpy(&last, counts + whole, Size - whole);
        take(last, whole);
        add_up();
        at_most -= padding;
        at_least -= offset == 0 ? padding : 0;
    }
    return {at_most, Size - at_least};
}

/// The same of counts and levels in 1/256 count; a difference of less than half a count is none in the tally,
/// as among whole counts.
template <std::size_t Size>
[[nodiscard]] level_tally subtract_levels(const std::uint16_t* counts, const std::uint16_t* levels,
                                          std::uint8_t offset, std::uint16_t* to) noexcept {
    constexpr int half = 128;
    std::uint32_t at_most = 0, below = 0;
    for (std::size_t i = 0; i < Size; ++i) {
        const int level = std::min(0xFFFF, levels[i] + offset * 256), above = counts[i] - level;
        to[i] = static_cast<std::uint16_t>(std::max(above, 0));
        at_most += static_cast<std::uint32_t>(above <= half);
        below += static_cast<std::uint32_t>(above < -half);
    }
    return {at_most, below};
}

/// Writes (count - untouched) * factor of `Size` counts, rounded and clamped to 16 bits. Counts that are
/// `broken`, NaN or infinite become 0, with a 1 in `marks`, others have a 0 there. Returns whether there is
/// any.
template <std::size_t Size, class Count>
[[nodiscard]] bool quantise(const Count* counts, float factor, float untouched, float broken,
                            std::uint16_t* to, std::uint16_t* marks) noexcept {
    constexpr std::size_t width = max_integer_lanes;
    using floats = float_vec<width>;
    using words = typename detail::compiler_vector<std::uint16_t, width>::type;
    int32_vec<width> any{};
    const auto take = [&](std::size_t i, std::size_t elements) {
        typename detail::compiler_vector<Count, width>::type loaded{};
        std::memcpy(&loaded, counts + i, elements * sizeof(Count));
        const floats count = __builtin_convertvector(loaded, floats);
        const auto magnitude =
            reinterpret_cast<int32_vec<width>>(count) & 0x7FFFFFFF; // of NaN, above infinity's
        const int32_vec<width> marked = (magnitude >= 0x7F800000) | (count == broken);
        floats scaled = marked ? floats{} : (count - untouched) * factor + 0.5f;
        scaled = scaled > 0.0f ? scaled : floats{};
        scaled = scaled < 65535.0f ? scaled : floats{} + 65535.0f;
        const auto rounded =
            __builtin_convertvector(__builtin_convertvector(scaled, int32_vec<width>), words);
        const auto mark = __builtin_convertvector(marked & 1, words);
        std::memcpy(to + i, &rounded, elements * sizeof(std::uint16_t));
        std::memcpy(marks + i, &mark, elements * sizeof(std::uint16_t));
        any |= marked;
    };
    for (std::size_t i = 0; i + width <= Size; i += width)
        take(i, width);
    if constexpr (Size % width > 0)
        take(Size / width * width, Size % width);
    std::int32_t all = 0;
    for (std::size_t lane = 0; lane < width; ++lane)
        all |= any[lane];
    return all != 0;
}

/// Moves each of `Size` levels, in 1/256 count, by `step` towards its count: up to less than `stuck`, and not
/// towards one that is `pressed` above it. Writes them as the elements of `counts`, 0 from `stuck` on.
template <std::size_t Size, class Count>
void follow_levels(const Count* counts, std::uint16_t step, std::uint16_t pressed, std::uint16_t stuck,
                   std::uint16_t* levels, Count* baseline) noexcept {
    constexpr std::size_t width = count_lanes / sizeof(std::uint16_t);
    constexpr int shift = sizeof(Count) == 1 ? 8 : 0;
    using words = detail::count_words<std::uint16_t>;
    using loaded = typename detail::compiler_vector<Count, width>::type;
    const auto most = static_cast<std::uint16_t>(stuck > 0 ? stuck - 1 : 0);
    const auto smaller = [](const words& a, const words& b) -> words { return a < b ? a : b; };
    const auto above = [](const words& a, const words& b) -> words { return (a < b ? b : a) - b; };
    const auto take = [&](std::size_t i, std::size_t elements) {
        loaded count{};
        words now{};
        std::memcpy(&count, counts + i, elements * sizeof(Count));
        std::memcpy(&now, levels + i, elements * sizeof(std::uint16_t));
        const words target = __builtin_convertvector(count, words) << shift;
        const words rise = above(target, now),
                    room = smaller(above(words{} + most, now), above(words{} + pressed, rise));
        const words up = smaller(words{} + step, room) & reinterpret_cast<words>(rise != 0);
        const words down = smaller(words{} + step, now) & reinterpret_cast<words>(above(now, target) != 0);
        const words next = now + up - down;
        const auto rounded =
            __builtin_convertvector(((next + static_cast<std::uint16_t>(shift * 16)) >> shift) &
                                        reinterpret_cast<words>(next < stuck),
                                    loaded);
        std::memcpy(levels + i, &next, elements * sizeof(std::uint16_t));
        std::memcpy(baseline + i, &rounded, elements * sizeof(Count));
    };
    for (std::size_t i = 0; i + width <= Size; i += width)
        take(i, width);
    if constexpr (Size % width > 0)
        take(Size / width * width, Size % width);
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
            if (pressed > 0) // or the zeros after the last count would be pressed
                take(last, area, force);
        }
        tally.area += detail::sum_lanes(detail::sum_pairs(area));
        tally.force += detail::sum_lanes(force);
    }
    return tally;
}

/// The same of fractions of counts, with their sum rounded.
template <std::size_t Size>
[[nodiscard]] pressed_tally tally_pressed(const float* counts, std::uint8_t pressed) noexcept {
    constexpr std::size_t lanes = 16; // added up apart, for vectors
    std::array<float, lanes> force{};
    std::array<std::uint32_t, lanes> area{};
    const auto take = [&](std::size_t i, std::size_t lane) {
        const bool is_pressed = counts[i] >= pressed;
        area[lane] += static_cast<std::uint32_t>(is_pressed);
        force[lane] += is_pressed ? counts[i] : 0.0f;
    };
    for (std::size_t i = 0; i + lanes <= Size; i += lanes)
        for (std::size_t lane = 0; lane < lanes; ++lane)
            take(i + lane, lane);
    for (std::size_t i = Size / lanes * lanes; i < Size; ++i)
        take(i, i % lanes);
    double sum = 0;
    pressed_tally tally;
    for (std::size_t lane = 0; lane < lanes; ++lane) {
        tally.area += area[lane];
        sum += static_cast<double>(force[lane]);
    }
    tally.force = static_cast<std::uint32_t>(sum + 0.5);
    return tally;
}

/// Calls visit(place) for each of `marks` that is not 0. Most words of eight bytes are 0.
template <class T, class Visit>
void visit_nonzero(const T* marks, std::size_t size, const Visit& visit) noexcept {
    constexpr std::size_t step = sizeof(std::uint64_t) / sizeof(T);
    for (std::size_t first = 0; first < size; first += step) {
        const std::size_t end = std::min(first + step, size);
        std::uint64_t word = 0;
        std::memcpy(&word, marks + first, (end - first) * sizeof(T));
        for (std::size_t i = first; word != 0 && i < end; ++i)
            if (marks[i] != 0)
                visit(i);
    }
}

}}} // namespace tactnet::kernels
