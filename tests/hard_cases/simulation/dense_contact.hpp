#pragma once

// References for contacts, made without the library: what a cell of a bonded layer does to another by
// quadrature in long double, and contacts by elimination on a dense matrix.

#include <cstddef>
#include <vector>

namespace hard_cases {

/// Cells in a rectangle, row by row, and how far each sinks when 1 Pa presses on another.
struct dense_surface {
    std::size_t rows, columns;
    std::vector<long double> sinking; ///< of the first cell's row and column distance, rows × columns

    [[nodiscard]] std::size_t cells() const { return rows * columns; }
    [[nodiscard]] long double between(std::size_t a, std::size_t b) const;
};

/// A half space of E / (1 − ν²) = 1 Pa with cells of side 1: Boussinesq's 1 ÷ (π r) over a cell.
[[nodiscard]] dense_surface dense_half_space(std::size_t rows, std::size_t columns);

/// A layer so many cells thick that is bonded to a rigid base.
[[nodiscard]] dense_surface dense_layer(std::size_t rows, std::size_t columns, double thickness,
                                        double poisson);

/// 1 − M of a bonded layer, by the textbook's formula: nothing cancels in it.
[[nodiscard]] long double held_back(long double x, long double poisson);

struct dense_contact {
    std::vector<long double> pressures;
    long double depth = 0;
    /// Largest sum of magnitudes in a row of the inverse: what a gap of 1 can do to a pressure.
    long double sensitivity = 0;
};

/// Pressures ≥ 0 that add up to `load`, gaps ≥ 0, one of both zero in each cell: cells that pull are let go,
/// cells that overlap are taken in, until there are none.
[[nodiscard]] dense_contact pressed_to(const dense_surface& surface, const std::vector<double>& heights,
                                       long double load);

} // namespace hard_cases
