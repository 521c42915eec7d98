#pragma once

#include <tactnet/kernels/frame/tactels.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

// Which tactels of a frame are unlike their neighbours, as broken ones are.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The distances of the eight neighbours of a tactel, in rows of `Columns`.
template <std::size_t Columns>
inline constexpr std::array<std::ptrdiff_t, 8> neighbour_distances = [] {
    constexpr auto row = static_cast<std::ptrdiff_t>(Columns);
    return std::array<std::ptrdiff_t, 8>{-row - 1, -row, -row + 1, -1, 1, row - 1, row, row + 1};
}();
/// The place of neighbour n of a tactel; Rows * Columns if it is beyond the array.
template <std::size_t Rows, std::size_t Columns>
[[nodiscard]] constexpr std::size_t neighbour_place(std::size_t place, std::size_t n) noexcept {
    constexpr std::array<std::size_t, 8> down{0, 0, 0, 1, 1, 2, 2, 2}, right{0, 1, 2, 0, 2, 0, 1, 2};
    const std::size_t y = place / Columns + down[n], x = place % Columns + right[n]; // from 1 on
    return y >= 1 && x >= 1 && y <= Rows && x <= Columns ? (y - 1) * Columns + x - 1 : Rows * Columns;
}

/// The limits of find_suspects: see tactnet::fault_limits.
template <class T>
struct basic_sign_limits {
    T spike, hole, pressed;
    std::uint8_t neighbours, ratio = 8;
};
using sign_limits = basic_sign_limits<std::uint8_t>;
inline constexpr std::uint8_t spike_sign = 1, hole_sign = 2;

/// The sign of one tactel. Neighbours beyond the array count 0.
template <std::size_t Rows, std::size_t Columns, class T>
[[nodiscard]] std::uint8_t sign_of(const T* counts, std::size_t place,
                                   const basic_sign_limits<T>& limits) noexcept {
    const T own = counts[place];
    unsigned low = 0, pressed = 0; // a bit for each neighbour
    for (std::size_t n = 0; n < 8; ++n) {
        const std::size_t neighbour = neighbour_place<Rows, Columns>(place, n);
        const T count = neighbour < Rows * Columns ? counts[neighbour] : T{0};
        low |= static_cast<unsigned>(count < own / limits.ratio) << n;
        pressed |= static_cast<unsigned>(count >= limits.pressed) << n;
    }
    // More than six rule out all but the ends of a row or column, unless all of it is alike.
    const auto enough = [&](unsigned speak, const auto& alike) {
        const auto line = [&](unsigned within, std::size_t first, std::size_t step, std::size_t end) {
            if ((speak | within) != 0xFF)
                return false;
            for (std::size_t i = first; i < end; i += step)
                if (!alike(counts[i]))
                    return false;
            return true;
        };
        const std::size_t row = place / Columns * Columns;
        return static_cast<unsigned>(std::popcount(speak)) >= limits.neighbours ||
               (limits.neighbours > 6 &&
                (line(0x18, row, 1, row + Columns) || line(0x42, place % Columns, Columns, Rows * Columns)));
    };
    return own >= limits.spike && enough(low, [&](T count) { return count >= limits.spike; }) ? spike_sign
           : own <= limits.hole && enough(pressed, [&](T count) { return count <= limits.hole; })
               ? hole_sign
               : std::uint8_t{0};
}

/// Compares each tactel with its eight neighbours, and writes spike_sign, hole_sign or 0 to `signs`, which
/// has whole vectors. `counts` is followed by zeros in whole vectors, and has Columns + 1 zeros around these.
/// Returns whether any sign is not 0.
template <std::size_t Rows, std::size_t Columns, class T>
[[nodiscard]] bool find_suspects(const T* counts, const basic_sign_limits<T> limits, T* signs) noexcept {
    constexpr std::size_t size = Rows * Columns;
    constexpr auto row = static_cast<std::ptrdiff_t>(Columns);
    constexpr T all = static_cast<T>(-1);
    using vector = detail::count_words<T>;
    // Of enough neighbours, at most four are corners. Nearly always the other four rule out every sign: one
    // of them must be low, or two pressed. At the edges of the array, vectors hold tactels of the next row
    // in place of zeros, which may hide a low neighbour, and in a single column hide both.
    const T low_anyway = limits.neighbours > 5 && Columns > 1 ? T{0} : all;
    const T pressed_anyway = limits.neighbours > 5 ? T{0} : all;
    const auto smaller = [](const vector& a, const vector& b) -> vector { return a < b ? a : b; };
    const auto larger = [](const vector& a, const vector& b) -> vector { return a < b ? b : a; };
    vector any{};
    for (std::size_t i = 0; i < size; i += count_lanes / sizeof(T)) {
        const T* const from = counts + i;
        const auto own = load_bytes_as<vector>(from);
        const auto above = load_bytes_as<vector>(from - row), below = load_bytes_as<vector>(from + row),
                   left = load_bytes_as<vector>(from - 1), right = load_bytes_as<vector>(from + 1);
        const vector low_of_column = smaller(above, below), high_of_column = larger(above, below),
                     low_of_row = smaller(left, right), high_of_row = larger(left, right);
        const vector lowest = smaller(low_of_column, low_of_row),
                     second = larger(larger(low_of_column, low_of_row), smaller(high_of_column, high_of_row));
        const vector spike = reinterpret_cast<vector>(own >= limits.spike) &
                             (~reinterpret_cast<vector>(lowest >= (own >> 3)) | low_anyway);
        const vector hole = reinterpret_cast<vector>(own <= limits.hole) &
                            (reinterpret_cast<vector>(second >= limits.pressed) | pressed_anyway);
        const vector suspects = spike | hole;
        store_any(signs + i, suspects);
        any |= suspects;
    }
    if (!detail::any_set(any))
        return false;
    bool found = false;
    visit_nonzero(signs, whole_count_vectors(size), [&](std::size_t place) {
        signs[place] = place < size ? sign_of<Rows, Columns>(counts, place, limits) : std::uint8_t{0};
        found = found || signs[place] != 0;
    });
    return found;
}

}}} // namespace tactnet::kernels
