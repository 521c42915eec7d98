// Matrices of resistors with lines that are broken or shorted. The reference reads each tactel by itself, by
// Kirchhoff's laws for all lines in long double.

#include "../hold.hpp"

#include <tactnet/simulation/effects/circuit/resistive_network.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <simulation/effect_frames.hpp>
#include <string>
#include <utility>
#include <vector>

using namespace tactnet;
using hard_cases::hold;
using hard_cases::outcome;
using hard_cases::unit;

namespace {

constexpr shape size{7, 13};
using frame = support::frame<size>;

/// One reading: voltages of the floating lines, by elimination with pivots.
double read_by_nodes(const frame& pressures, double grounding, std::size_t row, std::size_t column) {
    constexpr std::size_t lines = size.rows + size.columns;
    std::vector<std::vector<long double>> a(lines, std::vector<long double>(lines + 1));
    for (std::size_t i = 0; i < size.rows; ++i)
        for (std::size_t j = 0; j < size.columns; ++j) {
            const auto g = static_cast<long double>(pressures(i, j));
            a[i][i] += g, a[size.rows + j][size.rows + j] += g;
            a[i][size.rows + j] -= g, a[size.rows + j][i] -= g;
        }
    for (std::size_t line = 0; line < lines; ++line)
        a[line][line] += static_cast<long double>(grounding);
    for (const std::size_t held : {row, size.rows + column}) {
        a[held].assign(lines + 1, 0);
        a[held][held] = 1;
    }
    a[row][lines] = 1;
    for (std::size_t k = 0; k < lines; ++k) {
        std::size_t pivot = k;
        for (std::size_t i = k; i < lines; ++i)
            pivot = std::abs(a[i][k]) > std::abs(a[pivot][k]) ? i : pivot;
        std::swap(a[k], a[pivot]);
        for (std::size_t i = 0; i < lines; ++i) {
            const long double factor = i == k ? 0 : a[i][k] / a[k][k];
            for (std::size_t j = k; factor != 0 && j <= lines; ++j)
                a[i][j] -= factor * a[k][j];
        }
    }
    long double current = 0;
    for (std::size_t i = 0; i < size.rows; ++i)
        current += static_cast<long double>(pressures(i, column)) * a[i][lines] / a[i][i];
    return static_cast<double>(current);
}

/// A siemens is a pascal here. Readings are floats, denormal ones too. In double, a Cholesky factorisation of
/// the rows' matrix and its inverse are off by a few times the number of lines times 2⁻⁵³ times how much
/// better the best line conducts than what ties the lines to ground.
void check_circuit(const std::string& name, const frame& pressures, double grounding) {
    const frame read = support::after<size>(
        simulation::resistive_network{.sensitivity = 1, .grounding = grounding}, pressures);
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
    const double ground = std::max(grounding, 1e-9 * best);
    const double lost = 4 * (size.rows + size.columns) * 0x1p-53 * best / ground;
    std::vector<outcome> all;
    for (std::size_t row = 0; row < size.rows; ++row)
        for (std::size_t column = 0; column < size.columns; ++column) {
            const double exact = read_by_nodes(pressures, ground, row, column);
            all.push_back(
                {exact, static_cast<double>(read(row, column)), (0x1p-24 + lost) * exact + 0x1p-150});
        }
    hold("resistors, " + name, unit::absolute, all);
}

frame with(const std::vector<std::pair<std::size_t, float>>& rows,
           const std::vector<std::pair<std::size_t, float>>& columns) {
    frame pressures = support::pressed<size>(2);
    for (const auto& [row, value] : rows)
        for (std::size_t column = 0; column < size.columns; ++column)
            pressures(row, column) = value;
    for (const auto& [column, value] : columns)
        for (std::size_t row = 0; row < size.rows; ++row)
            pressures(row, column) = value;
    return pressures;
}

} // namespace

TEST_CASE("resistive_network: broken and shorted lines") {
    for (const double grounding : {0.0, 3e4}) {
        const std::string tied = grounding > 0 ? ", grounded lines" : ", floating lines";
        check_circuit("a row and a column broken" + tied, with({{2, 0.0f}}, {{5, 0.0f}}), grounding);
        check_circuit("all but one row broken" + tied,
                      with({{0, 0.0f}, {1, 0.0f}, {2, 0.0f}, {4, 0.0f}, {5, 0.0f}, {6, 0.0f}}, {}),
                      grounding);
        check_circuit("a row shorted" + tied, with({{2, 3e8f}}, {}), grounding);
        check_circuit("a row shorted, a column broken" + tied, with({{2, 3e8f}}, {{5, 0.0f}}), grounding);
        frame one = with({}, {});
        one(3, 4) = 1e12f;
        check_circuit("one tactel shorted" + tied, one, grounding);
        frame faint = with({}, {});
        for (float& pressure : faint)
            pressure *= 1e-35f;
        check_circuit("pressures of 1e-31" + tied, faint, grounding > 0 ? 1e-31 : 0);
    }
}
