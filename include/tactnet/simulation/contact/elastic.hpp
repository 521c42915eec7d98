#pragma once

#include <tactnet/simulation/elasticity/layer_compliance.hpp>
#include <tactnet/simulation/elasticity/polonsky_keer.hpp>

#include <algorithm>
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

/// The influence of cells on a bonded layer: that of a half space, Love's exact sum, minus the restraint by
/// the rigid base, which is smooth on the scale of the thickness. At a distance r from a point force F the
/// restraint is
///
///     F / (π E* h) ∫₀^∞ (1 − M(x)) J₀(x r / h) dx.
class layer_influence {
public:
    /// Takes a thickness in metres, zero or more; at least a hundredth of a cell is used.
    layer_influence(double thickness, double poisson, double cell)
        : cell_(cell),
          thickness_(thickness > 1e-2 * cell ? thickness / cell : 1e-2),
          held_back_([=](double x) { return layer_stiffening(x, poisson); }, 16) {}

    /// The deflection in metres under 1 Pa on a cell that many cells away, for E / (1 − ν²) = 1 Pa.
    [[nodiscard]] double operator()(std::size_t rows, std::size_t columns) const {
        const double x = static_cast<double>(columns), y = static_cast<double>(rows);
        if (std::hypot(x, y) > radial_kernel::support * thickness_ + 1)
            return 0; // not the difference of two rounded numbers
        const rectangle square{x - 0.5, x + 0.5, y - 0.5, y + 0.5};
        const double held = integrate(square, 2 * thickness_, [&](double across, double along) {
            return held_back_(std::hypot(across, along) / thickness_);
        });
        // A thin incompressible layer yields less than the rounding of the difference. A cell's influence on
        // itself must be larger, or the solver would find pressures that lift the surface.
        const double least = rows + columns == 0 ? 1e-6 * std::min(thickness_, 1.0) : 0;
        return cell_ * ((love_integral(x, y) - held / thickness_) / std::numbers::pi + least);
    }

private:
    double cell_, thickness_; // in cells
    radial_kernel held_back_;
};

/// A soft layer bonded to a rigid sensor, as on most sensors. By default 3 mm of soft rubber foam.
///
/// If ν is close to ½, use cells of at most about twice the thickness: such a layer yields sideways, hardly
/// at all in the middle of a uniformly pressed cell.
struct bonded_layer {
    double young = 1e5;      ///< E in pascals
    double poisson = 0.3;    ///< ν, more than −1 and at most ½
    double thickness = 3e-3; ///< metres; infinite for a half space
    contact_accuracy accuracy{};

    template <shape Shape>
    class bound : public polonsky_keer<Shape> {
    public:
        bound(const bonded_layer& model, double cell)
            : bound(model, cell, layer_influence(model.thickness, model.poisson, cell)) {}

    private:
        bound(const bonded_layer& model, double cell, const layer_influence& influence)
            : polonsky_keer<Shape>(
                  [&](std::size_t rows, std::size_t columns) {
                      return influence(rows, columns) * ((1 - model.poisson * model.poisson) / model.young);
                  },
                  [&](std::size_t rows, std::size_t columns) {
                      return half_space_influence(rows, columns, cell);
                  },
                  cell, model.accuracy) {}
    };
};

// The compliance of a sensor depends more on its backing than on the film. On a metal plate it is
// rigid, on foam semi-rigid, and on a soft body without a frame it is flexible and bends round the object.
// The softer it is, the more tactels share a force and the less each of them bears: the contact grows, and
// the range from faint to strong shrinks.
//
// All three are bonded layers; the bending stiffness of the film is neglected. Thicknesses are usual ones,
// and moduli lie in the range of silicone of Shore 20 A (about 0.7 MPa), foam rubber and upholstery foam.
// They are chosen, not measured; the tests check the order of the three. That order does not hold for an
// object that is flat to hundredths of a millimetre and pressed lightly: its rim cuts deeper into the softer
// sensor.

/// A film under a thin rubber skin on a metal plate.
inline constexpr bonded_layer rigid_sensor{.young = 7e5, .poisson = 0.48, .thickness = 1e-3};
/// A film on a mat of foam rubber.
inline constexpr bonded_layer semi_rigid_sensor{.young = 1e5, .poisson = 0.3, .thickness = 3e-3};
/// A film on a thick soft body.
inline constexpr bonded_layer flexible_sensor{.young = 3e4, .poisson = 0.1, .thickness = 12e-3};

}}} // namespace tactnet::simulation
