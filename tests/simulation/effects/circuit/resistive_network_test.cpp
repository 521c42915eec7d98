#include <tactnet/simulation/effects/circuit/resistive_network.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <simulation/effect_frames.hpp>
#include <support/same_bits.hpp>
#include <utility>
#include <vector>

using namespace tactnet;
using simulation::resistive_network;

namespace {

/// Gauss's elimination with pivots.
std::vector<long double> solved(std::vector<std::vector<long double>> a, std::vector<long double> b) {
    const std::size_t n = b.size();
    for (std::size_t k = 0; k < n; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k; i < n; ++i)
            pivot = std::abs(a[i][k]) > std::abs(a[pivot][k]) ? i : pivot;
        std::swap(a[k], a[pivot]), std::swap(b[k], b[pivot]);
        for (std::size_t i = k + 1; i < n; ++i) {
            const long double factor = a[i][k] / a[k][k];
            for (std::size_t j = k; j < n; ++j)
                a[i][j] -= factor * a[k][j];
            b[i] -= factor * b[k];
        }
    }
    for (std::size_t k = n; k-- > 0;) {
        for (std::size_t j = k + 1; j < n; ++j)
            b[k] -= a[k][j] * b[j];
        b[k] /= a[k][k];
    }
    return b;
}

/// One tactel read by Kirchhoff's laws: unknown are the voltages of all lines but the two that are held. The
/// conductances are those of the tactels in pascals, and of each free line to ground.
template <shape Shape>
double read_by_nodes(const support::frame<Shape>& pressures, double grounding, std::size_t row,
                     std::size_t column) {
    const std::size_t lines = Shape.rows + Shape.columns, ground_line = Shape.rows + column;
    std::vector<std::vector<long double>> a(lines, std::vector<long double>(lines));
    std::vector<long double> voltages(lines);
    for (std::size_t i = 0; i < Shape.rows; ++i)
        for (std::size_t j = 0; j < Shape.columns; ++j) {
            const auto g = static_cast<double>(pressures(i, j));
            a[i][i] += g, a[Shape.rows + j][Shape.rows + j] += g;
            a[i][Shape.rows + j] -= g, a[Shape.rows + j][i] -= g;
        }
    for (std::size_t line = 0; line < lines; ++line)
        a[line][line] += grounding;
    for (const std::size_t held : {row, ground_line}) {
        a[held].assign(lines, 0);
        a[held][held] = 1;
    }
    voltages[row] = 1;
    voltages = solved(a, voltages);
    long double current = 0;
    for (std::size_t i = 0; i < Shape.rows; ++i)
        current += static_cast<double>(pressures(i, column)) * voltages[i];
    return static_cast<double>(current);
}

template <shape Shape>
void check_against_nodes(const support::frame<Shape>& pressures, double grounding, double tolerance) {
    // A siemens is a pascal here.
    const auto read =
        support::after<Shape>(resistive_network{.sensitivity = 1, .grounding = grounding}, pressures);
    double largest = 0;
    for (const float pressure : pressures)
        largest = std::max(largest, static_cast<double>(pressure));
    for (std::size_t row = 0; row < Shape.rows; row += 1 + Shape.rows / 8)
        for (std::size_t column = 0; column < Shape.columns; column += 1 + Shape.columns / 8) {
            const double expected = read_by_nodes<Shape>(pressures, grounding, row, column);
            CHECK(std::abs(static_cast<double>(read(row, column)) - expected) <=
                  tolerance * std::max(expected, 1e-3 * largest));
        }
}

} // namespace

// Readings are floats: half a unit in the last place, and as much for what is small compared with the
// largest.
TEST_CASE("resistive_network: a nodal solution of each reading by itself") {
    for (std::uint32_t sample = 0; sample < 3; ++sample)
        for (const double grounding : {1e-1, 1e2, 1e4, 1e7}) {
            CAPTURE(grounding);
            check_against_nodes<shape{5, 7}>(support::pressed<shape{5, 7}>(sample), grounding, 0x1p-23);
            check_against_nodes<shape{7, 4}>(support::pressed<shape{7, 4}>(sample), grounding, 0x1p-23);
        }
    check_against_nodes<shape{28, 50}>(support::pressed<shape{28, 50}>(), 100, 0x1p-23);
    check_against_nodes<shape{1, 6}>(support::pressed<shape{1, 6}>(), 100, 0x1p-23);
    check_against_nodes<shape{6, 1}>(support::pressed<shape{6, 1}>(), 100, 0x1p-23);
}
// In double, a Cholesky factorisation of the rows' matrix and its inverse are off by a few times the number
// of lines times 2⁻⁵³ times how much better the best line conducts than what ties the lines to ground.
TEST_CASE("resistive_network: broken and shorted lines") {
    constexpr shape size{7, 13};
    const auto with = [&](const std::vector<std::size_t>& broken_rows, float row, float column) {
        support::frame<size> pressures = support::pressed<size>(2);
        for (const std::size_t r : broken_rows)
            for (std::size_t c = 0; c < size.columns; ++c)
                pressures(r, c) = row;
        for (std::size_t r = 0; column == 0 && r < size.rows; ++r)
            pressures(r, 5) = column;
        return pressures;
    };
    auto shorted = with({}, 0, 1), faint = shorted;
    shorted(3, 4) = 1e12f;
    for (float& pressure : faint)
        pressure *= 1e-35f;
    for (const bool grounded : {false, true})
        for (const auto& pressures : {with({2}, 0, 0), with({0, 1, 2, 4, 5, 6}, 0, 1), with({2}, 3e8f, 1),
                                      with({2}, 3e8f, 0), shorted, faint}) {
            const double grounding = !grounded ? 0 : pressures(3, 3) < 1e-20f ? 1e-31 : 3e4;
            const auto read =
                support::after<size>(resistive_network{.sensitivity = 1, .grounding = grounding}, pressures);
            double best = 0;
            for (std::size_t i = 0; i < size.rows; ++i) {
                double sum = 0;
                for (std::size_t j = 0; j < size.columns; ++j)
                    sum += static_cast<double>(pressures(i, j));
                best = std::max(best, sum);
            }
            for (std::size_t j = 0; j < size.columns; ++j) {
                double sum = 0;
                for (std::size_t i = 0; i < size.rows; ++i)
                    sum += static_cast<double>(pressures(i, j));
                best = std::max(best, sum);
            }
            // resistive_network documents that such a network counts as grounded by 1e-9 of its best line.
            const double ground = std::max(grounding, 1e-9 * best),
                         lost = 4 * (size.rows + size.columns) * 0x1p-53 * best / ground;
            for (std::size_t row = 0; row < size.rows; ++row)
                for (std::size_t column = 0; column < size.columns; ++column) {
                    const double exact = read_by_nodes<size>(pressures, ground, row, column);
                    CHECK(std::abs(static_cast<double>(read(row, column)) - exact) <=
                          (0x1p-24 + lost) * exact + 0x1p-150);
                }
        }
}
TEST_CASE("resistive_network: three corners of a rectangle show a ghost at the fourth") {
    constexpr shape size{4, 5};
    auto pressures = support::filled<size>(0);
    pressures(0, 1) = pressures(0, 3) = pressures(2, 1) = 3000;
    const auto free = support::after<size>(resistive_network{.sensitivity = 1, .grounding = 0}, pressures);
    // Three resistors one after the other, and those that are pressed themselves; nothing anywhere else. Free
    // lines are counted as grounded by 10⁻⁹ of the best conductance.
    CHECK(free(2, 3) == doctest::Approx(1000).epsilon(1e-6));
    CHECK(free(0, 1) == doctest::Approx(3000).epsilon(1e-6));
    CHECK(free(1, 2) == doctest::Approx(0));
    CHECK(std::abs(free(3, 3)) < 1e-4f);
    double ghost = 1000;
    for (const double grounding : {1e2, 1e4, 1e6}) {
        const auto read =
            support::after<size>(resistive_network{.sensitivity = 1, .grounding = grounding}, pressures);
        CHECK(static_cast<double>(read(2, 3)) < ghost);
        ghost = static_cast<double>(read(2, 3));
    }
}
TEST_CASE("resistive_network: pressures below zero conduct nothing") {
    constexpr shape size{9, 11};
    auto pressures = support::pressed<size>();
    auto lower = pressures;
    for (float& pressure : lower)
        pressure = pressure > 0 ? pressure : -100;
    CHECK(support::same_bits(support::after<size>(resistive_network{}, pressures),
                             support::after<size>(resistive_network{}, lower)));
}
