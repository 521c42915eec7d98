#pragma once

#include <tactnet/kernels/map/symmetric_convolution.hpp>
#include <tactnet/simulation/effect.hpp>
#include <tactnet/simulation/elasticity/layer_compliance.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// Averages the pressure on each tactel. A scene with this effect computes contact and pad on `Cells` ×
/// `Cells` cells per tactel, else on one cell per tactel.
template <std::size_t Cells>
struct tactel_average {
    static_assert(Cells > 0, "tactel_average: there must be at least one cell a tactel");
    static constexpr stage place = stage::tactel;
    static constexpr std::size_t refinement = Cells;
    template <shape In>
    static constexpr shape output{In.rows / Cells, In.columns / Cells};

    template <shape Shape>
    class bound {
    public:
        static constexpr shape tactels = output<Shape>;

        bound(const tactel_average&, const mounting&) {}
        void apply(tensor_view<const float, Shape> cells, signal<tactels> means,
                   const moment&) const noexcept {
            constexpr float share = 1.0f / static_cast<float>(Cells * Cells);
            for (std::size_t row = 0; row < tactels.rows; ++row)
                for (std::size_t column = 0; column < tactels.columns; ++column) {
                    float sum = 0;
                    for (std::size_t y = 0; y < Cells; ++y)
                        for (std::size_t x = 0; x < Cells; ++x)
                            sum += cells(row * Cells + y, column * Cells + x);
                    means(row, column) = sum * share;
                }
        }
    };
};

/// The fraction of the force on a cell that reaches the film under a cell that many rows and columns away
/// through a bonded layer: the transfer function of the layer as a function of distance, averaged over both
/// cells. On an infinite array the fractions add up to one.
class pad_shares {
public:
    /// `thickness` in cells.
    pad_shares(double thickness, double poisson)
        : thickness_(thickness), pressure_([=](double x) { return x * layer_transfer(x, poisson); }, 30) {}

    /// The fraction for a cell that many rows and columns away.
    [[nodiscard]] double operator()(std::size_t rows, std::size_t columns) const {
        const double x = static_cast<double>(columns), y = static_cast<double>(rows);
        // The overlap of two cells is a triangular function of their distance.
        const auto share = [&](double across, double along) {
            return pressure_(std::hypot(across, along) / thickness_) * (1 - std::abs(across - x)) *
                   (1 - std::abs(along - y));
        };
        double sum = 0;
        for (const double left : {x - 1, x})
            for (const double bottom : {y - 1, y})
                sum += integrate({left, left + 1, bottom, bottom + 1}, thickness_, share);
        return sum / (2 * std::numbers::pi * thickness_ * thickness_);
    }

private:
    double thickness_;
    radial_kernel pressure_;
};

/// A soft pad bonded to a stiff film, which spreads the pressure on it. The pad extends beyond the array,
/// where force is lost to the tactels. The farthest 0.2 % of a force are distributed over the nearer cells.
///
/// With a contact<bonded_layer>, give the pad the thickness and ν of that layer.
///
/// With ν below about ¼, the film would be pulled in some places; it shows no pull. A pad thinner than a
/// millionth of a cell changes no bit; an infinitely thick one transmits nothing.
struct elastic_pad {
    static constexpr stage place = stage::pad;
    static constexpr bool same_in_every_sensor = true;

    double thickness = 1.6e-3; ///< metres; the default makes imprints as wide as the paper's
    double poisson = 0.48;     ///< ν of soft rubber, more than −1 and at most ½

    template <shape Shape>
    class bound {
    public:
        bound(const elastic_pad& effect, const mounting& where)
            : spreads_(effect.thickness > 1e-6 * where.cell),
              stencil_(spreads_ ? spread(effect.thickness / where.cell, effect.poisson)
                                : kernels::symmetric_stencil<Shape>(
                                      0, [](std::size_t, std::size_t) { return 1.0f; })) {}

        void apply(signal<Shape> pressures, const moment&) noexcept {
            if (spreads_)
                stencil_.apply(pressures.data());
        }

    private:
        /// `thickness` in cells.
        static kernels::symmetric_stencil<Shape> spread(double thickness, double poisson) {
            constexpr double account = 0.002;
            constexpr std::size_t longest = std::max(Shape.rows, Shape.columns) - 1, side = longest + 1;
            const pad_shares shares(thickness, poisson);
            std::vector<double> quadrant(side * side);
            double sum = 0;
            bool whole = false;
            std::size_t radius = 0;
            for (;; ++radius) { // ring by ring, until the rest is negligible
                double ring = 0;
                for (std::size_t near = 0; near <= radius; ++near) {
                    const double share = shares(near, radius);
                    quadrant[near * side + radius] = quadrant[radius * side + near] = share;
                    ring += share * (radius == 0 ? 1 : near == 0 || near == radius ? 4 : 8);
                }
                sum += ring;
                whole = std::abs(1 - sum) <= account && (radius == 0 || std::abs(ring) <= account);
                if (whole || radius == longest)
                    break;
            }
            const double scale = whole ? 1 / sum : 1; // else force leaves the array
            return kernels::symmetric_stencil<Shape>(radius, [&](std::size_t rows, std::size_t columns) {
                return static_cast<float>(quadrant[rows * side + columns] * scale);
            });
        }

        bool spreads_;
        kernels::symmetric_stencil<Shape> stencil_;
    };
};

}}} // namespace tactnet::simulation
