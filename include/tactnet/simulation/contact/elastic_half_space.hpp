#pragma once

#include <tactnet/simulation/elasticity/polonsky_keer.hpp>

#include <cmath>
#include <cstddef>
#include <numbers>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// ∬ 1 / √(x² + y²) over the unit square with its centre at (x, y): Love's deflection of a half space under a
/// uniform pressure on a rectangle (Phil. Trans. A 228, 1929, 377-420; Johnson, Contact Mechanics, 1985,
/// equation 3.25).
[[nodiscard]] inline double love_integral(double x, double y) {
    const auto corner = [](double a, double b) {
        return a * std::asinh(b / std::abs(a)) + b * std::asinh(a / std::abs(b));
    };
    const double left = x - 0.5, right = x + 0.5, bottom = y - 0.5, top = y + 0.5;
    return corner(right, top) - corner(left, top) - corner(right, bottom) + corner(left, bottom);
}

/// The deflection in metres of a half space of E / (1 − ν²) = 1 Pa in the middle of a cell, under 1 Pa on the
/// cell that many rows and columns away.
[[nodiscard]] inline double half_space_influence(std::size_t rows, std::size_t columns, double cell) {
    return cell / std::numbers::pi * love_integral(static_cast<double>(columns), static_cast<double>(rows));
}

/// A surface that is soft to a depth much larger than the contact, as a block of rubber. Exact for pressures
/// that are uniform over each cell.
struct elastic_half_space {
    double young = 1e6;   ///< E in pascals
    double poisson = 0.5; ///< ν
    contact_accuracy accuracy{};

    template <shape Shape>
    class bound : public polonsky_keer<Shape> {
    public:
        bound(const elastic_half_space& model, double cell)
            : polonsky_keer<Shape>(
                  [&](std::size_t rows, std::size_t columns) {
                      return half_space_influence(rows, columns, cell) *
                             ((1 - model.poisson * model.poisson) / model.young);
                  },
                  [&](std::size_t rows, std::size_t columns) {
                      return half_space_influence(rows, columns, cell);
                  },
                  cell, model.accuracy) {}
    };
};

}}} // namespace tactnet::simulation
