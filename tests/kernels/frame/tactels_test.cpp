#include <tactnet/kernels/frame/suspects.hpp>
#include <tactnet/kernels/frame/tactels.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

using namespace tactnet::kernels;

namespace {

std::vector<std::uint8_t> random_counts(std::size_t size, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<std::uint8_t> counts(size);
    for (std::uint8_t& count : counts)
        count = static_cast<std::uint8_t>(random() & 0xFF);
    return counts;
}

template <std::size_t Size>
void check_levels() {
    for (const unsigned each : {0U, 1U, 100U, 255U}) {
        const auto offset = static_cast<std::uint8_t>(each);
        const auto counts = random_counts(Size, 1 + each);
        auto levels = random_counts(Size, 2 + each);
        levels.resize(whole_count_vectors(Size));
        std::vector<std::uint8_t> found(levels.size(), 7);
        const level_tally tally = subtract_levels<Size>(counts.data(), levels.data(), offset, found.data());
        std::size_t wrong = 0, at_most = 0, below = 0;
        for (std::size_t i = 0; i < Size; ++i) {
            const int level = std::min(255, levels[i] + offset);
            wrong += found[i] != std::max(0, counts[i] - level);
            at_most += counts[i] <= level;
            below += counts[i] < level;
        }
        CHECK(wrong == 0);
        CHECK(tally.at_most == at_most);
        CHECK(tally.below == below);
        CHECK(std::count(found.begin() + Size, found.end(), 0) == std::ptrdiff_t(found.size() - Size));
    }
}

/// An array of counts with zeros around it, as find_suspects reads it.
template <std::size_t Rows, std::size_t Columns>
struct surrounded {
    static constexpr std::size_t size = Rows * Columns, padded = whole_count_vectors(size);
    std::vector<std::uint8_t> all = std::vector<std::uint8_t>(padded + 2 * Columns + 2);
    std::uint8_t* counts = all.data() + Columns + 1;
    std::vector<std::uint8_t> signs = std::vector<std::uint8_t>(padded, 7);

    bool find(const sign_limits& limits) {
        return find_suspects<Rows, Columns>(counts, limits, signs.data());
    }
    /// A count, or 0 beyond the array. Rows and columns count from 1.
    std::uint8_t at(std::size_t y, std::size_t x) const {
        return y >= 1 && x >= 1 && y <= Rows && x <= Columns ? counts[(y - 1) * Columns + x - 1]
                                                             : std::uint8_t{0};
    }
};

template <std::size_t Rows, std::size_t Columns>
void check_signs() {
    for (std::uint32_t seed = 0; seed < 90; ++seed) {
        const sign_limits limits{60, 40, 120, static_cast<std::uint8_t>(seed % 9), // with any neighbours
                                 static_cast<std::uint8_t>(seed % 2 == 0 ? 8 : 20)};
        surrounded<Rows, Columns> array;
        const auto counts = random_counts(Rows * Columns, seed);
        const std::size_t row = seed % (2 * Rows), column = seed / 2 % (2 * Columns); // often beyond
        for (std::size_t i = 0; i < counts.size(); ++i) { // many low and many pressed ones
            array.counts[i] = counts[i] < 100 ? static_cast<std::uint8_t>(counts[i] / 12) : counts[i];
            if (i / Columns == row || i % Columns == column)
                array.counts[i] = seed % 3 == 0 ? 255 : seed % 3 == 1 ? 0 : array.counts[i];
            else if (i / Columns + 1 == row || i / Columns == row + 1 || i % Columns + 1 == column ||
                     i % Columns == column + 1)
                array.counts[i] = seed % 3 == 0 ? 5 : seed % 3 == 1 ? 200 : array.counts[i];
        }
        const bool any = array.find(limits);
        std::size_t wrong = 0, found = 0;
        for (std::size_t y = 1; y <= Rows; ++y)
            for (std::size_t x = 1; x <= Columns; ++x) {
                const int own = array.at(y, x);
                const bool spike = own >= limits.spike;
                const auto fits = [&](int count) {
                    return spike ? count >= limits.spike : count <= limits.hole;
                };
                bool row_fits = limits.neighbours > 6, column_fits = row_fits;
                for (std::size_t i = 1; i <= Columns; ++i)
                    row_fits = row_fits && fits(array.at(y, i));
                for (std::size_t i = 1; i <= Rows; ++i)
                    column_fits = column_fits && fits(array.at(i, x));
                int speak = 0, beside_row = 0, beside_column = 0;
                for (const std::size_t i : {y - 1, y, y + 1})
                    for (const std::size_t j : {x - 1, x, x + 1})
                        if ((i != y || j != x) && (spike ? array.at(i, j) < own / limits.ratio
                                                         : array.at(i, j) >= limits.pressed)) {
                            ++speak;
                            beside_row += i != y;
                            beside_column += j != x;
                        }
                const bool is_sign = (spike || own <= limits.hole) &&
                                     (speak >= limits.neighbours || (row_fits && beside_row == 6) ||
                                      (column_fits && beside_column == 6));
                const int sign = array.signs[(y - 1) * Columns + x - 1];
                wrong += sign != (!is_sign ? 0 : spike ? spike_sign : hole_sign);
                found += sign != 0;
            }
        CHECK(wrong == 0);
        CHECK(any == (found != 0));
        CHECK((Rows * Columns < 1000 || found > 0 || limits.neighbours > 6));
        CHECK(std::count(array.signs.begin() + Rows * Columns, array.signs.end(), 0) ==
              std::ptrdiff_t(array.signs.size() - Rows * Columns));
    }
}

/// One spike and one hole at each place of an array of zeros or of pressed tactels, and with each number of
/// neighbours that speak for it, corners first and corners last. Zeros beyond the array speak for a spike.
void check_lone_signs() {
    constexpr std::size_t rows = 7, columns = 15;
    constexpr std::array<std::size_t, 8> corners_last{1, 3, 4, 6, 0, 2, 5, 7};
    const sign_limits limits{100, 0, 20, 6};
    std::size_t wrong = 0;
    for (const bool hole : {false, true})
        for (const bool reversed : {false, true})
            for (std::size_t place = 0; place < rows * columns; ++place)
                for (std::size_t speak = 0; speak <= 8; ++speak) {
                    surrounded<rows, columns> array;
                    std::fill_n(array.counts, rows * columns, std::uint8_t(hole ? 9 : 50));
                    array.counts[place] = hole ? 0 : 100;
                    std::size_t speaking = 0;
                    for (std::size_t n = 0; n < 8; ++n) {
                        const std::size_t neighbour =
                            neighbour_place<rows, columns>(place, corners_last[reversed ? 7 - n : n]);
                        if (neighbour == rows * columns)
                            speaking += !hole;
                        else if (n < speak) {
                            array.counts[neighbour] = hole ? 20 : 11;
                            ++speaking;
                        }
                    }
                    const bool any = array.find(limits);
                    const std::uint8_t expected = speaking < 6 ? std::uint8_t{0}
                                                  : hole       ? hole_sign
                                                               : spike_sign;
                    wrong += any != (speaking >= 6) || array.signs[place] != expected;
                }
    CHECK(wrong == 0);
}

template <std::size_t Size>
void check_pressed() {
    for (const unsigned each : {1U, 8U, 200U, 255U}) {
        const auto pressed = static_cast<std::uint8_t>(each);
        const auto counts = random_counts(Size, each);
        const pressed_tally tally = tally_pressed<Size>(counts.data(), pressed);
        std::size_t area = 0, force = 0;
        for (const std::uint8_t count : counts)
            if (count >= pressed)
                ++area, force += count;
        CHECK(tally.area == area);
        CHECK(tally.force == force);
    }
    const std::vector<std::uint8_t> all(Size, 255);
    CHECK(tally_pressed<Size>(all.data(), 1).area == Size);
    CHECK(tally_pressed<Size>(all.data(), 1).force == 255 * Size);
}

} // namespace

TEST_CASE("subtract_levels: each count less its level and the offset, for any number of counts") {
    check_levels<1>();
    check_levels<count_lanes>();
    check_levels<28 * 50>();
    check_levels<300 * count_lanes + 5>(); // more than a byte counts
}

TEST_CASE("neighbour_place: the eight neighbours, where the array has them") {
    std::size_t inside = 0;
    for (std::size_t place = 0; place < 12; ++place)
        for (std::size_t n = 0; n < 8; ++n) {
            const std::size_t neighbour = neighbour_place<3, 4>(place, n);
            if (neighbour == 12)
                continue;
            ++inside;
            CHECK(static_cast<std::ptrdiff_t>(neighbour) ==
                  static_cast<std::ptrdiff_t>(place) + neighbour_distances<4>[n]);
            CHECK(neighbour % 4 + 1 - place % 4 <= 2); // in the same column, or the one beside it
        }
    CHECK(inside == 4 * 3 + 6 * 5 + 2 * 8); // of corners, edges and the rest
}

TEST_CASE("find_suspects: spikes and holes, as a loop over neighbours finds them") {
    check_signs<1, 1>();
    check_signs<6, 1>();
    check_signs<1, 6>();
    check_signs<5, 2>();
    check_signs<7, 13>();
    check_signs<28, 50>();
    check_lone_signs();
}

TEST_CASE("tally_pressed: area and force of pressed tactels, for any number of tactels") {
    check_pressed<1>();
    check_pressed<7 * 13>();
    check_pressed<28 * 50>();
    check_pressed<count_lanes>();
    check_pressed<127 * count_lanes>();
    check_pressed<128 * count_lanes>();
    check_pressed<129 * count_lanes>();
    check_pressed<254 * count_lanes + 3>();
    check_pressed<20'000>();
}
