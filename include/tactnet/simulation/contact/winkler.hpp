#pragma once

#include <tactnet/simulation/contact/contact.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

// The fast contact model: independent springs. It is the limit of a compressible elastic layer on a rigid
// base that is thin compared with the contact (Johnson, Contact Mechanics, 1985, section 4.3).

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// A foundation of springs: pressure = modulus × depth / thickness. By default 3 mm of soft rubber foam.
struct winkler {
    double modulus = 1.35e5; ///< pascals, of a laterally confined layer: (1 − ν) E / ((1 + ν)(1 − 2ν))
    double thickness = 3e-3; ///< metres

    template <shape Shape>
    class bound {
    public:
        bound(const winkler& model, double cell)
            : modulus_(model.modulus), thickness_(model.thickness), area_(cell * cell) {}

        /// Solves exactly, up to rounding. A deformable object is a second layer of springs.
        contact_report solve(tensor_view<const float, Shape> heights, const pressing& press,
                             signal<Shape> pressures) const noexcept {
            const double stiffness =
                1 / (thickness_ / modulus_ + press.object_thickness * press.object_softness());
            const double lowest = lowest_of(heights);
            contact_report report;
            if (!(lowest < no_object) || !(press.amount < no_object))
                report.converged = !(press.amount > 0); // no object, or an infinite amount
            else if (press.until == pressing::goal::depth)
                report.depth = std::max(press.amount, 0.0);
            else
                report.depth = depth_for(heights, lowest, press.amount / (stiffness * area_), report);
            report.force =
                press_to(heights, lowest, report.depth, stiffness, pressures, report.cells) * area_;
            return report;
        }

    private:
        static constexpr double no_object = std::numeric_limits<float>::max();
        static constexpr std::size_t lanes = 8; // independent sums, for vectors

        static double lowest_of(tensor_view<const float, Shape> heights) {
            std::array<float, lanes> lowest;
            lowest.fill(std::numeric_limits<float>::infinity());
            for_lanes([&](std::size_t i, std::size_t lane) {
                const float height = heights.data()[i];
                const bool lower = height < lowest[lane] && height >= -std::numeric_limits<float>::max();
                lowest[lane] = lower ? height : lowest[lane];
            });
            return static_cast<double>(*std::min_element(lowest.begin(), lowest.end()));
        }

        /// The depth of the lowest point at which all depths add up to `sum`. Heights are relative to the
        /// lowest point, so that faint touches keep their digits. Each level has at least the springs of the
        /// solution, so that each step drops some springs until none is dropped.
        static double depth_for(tensor_view<const float, Shape> heights, double lowest, double sum,
                                contact_report& report) {
            double level = no_object - lowest;
            for (std::size_t touching = Shape.size() + 1; sum > 0;) {
                std::array<double, lanes> relative{}, counts{};
                for_lanes([&](std::size_t i, std::size_t lane) {
                    const double above = static_cast<double>(heights.data()[i]) - lowest;
                    const bool touches = above < level && above >= 0;
                    relative[lane] += touches ? above : 0;
                    counts[lane] += touches ? 1 : 0;
                });
                double total = 0, count = 0;
                for (std::size_t lane = 0; lane < lanes; ++lane)
                    total += relative[lane], count += counts[lane];
                ++report.iterations;
                if (static_cast<std::size_t>(count) >= touching || !(count > 0))
                    return level;
                touching = static_cast<std::size_t>(count);
                level = (sum + total) / count;
            }
            return 0;
        }

        /// Returns the sum of the pressures.
        static double press_to(tensor_view<const float, Shape> heights, double lowest, double deepest,
                               double stiffness, signal<Shape> pressures, std::size_t& cells) {
            std::array<double, lanes> sums{}, counts{};
            for_lanes([&](std::size_t i, std::size_t lane) {
                const double above = static_cast<double>(heights.data()[i]) - lowest, depth = deepest - above;
                const double pressure = depth > 0 && above >= 0 ? stiffness * depth : 0;
                pressures.data()[i] = static_cast<float>(pressure);
                sums[lane] += pressure;
                counts[lane] += pressure > 0 ? 1 : 0;
            });
            double sum = 0, count = 0;
            for (std::size_t lane = 0; lane < lanes; ++lane)
                sum += sums[lane], count += counts[lane];
            cells = static_cast<std::size_t>(count);
            return sum;
        }

        template <class Body>
        static void for_lanes(const Body& body) {
            constexpr std::size_t whole = Shape.size() / lanes * lanes;
            for (std::size_t i = 0; i < whole; i += lanes)
                for (std::size_t lane = 0; lane < lanes; ++lane)
                    body(i + lane, lane);
            for (std::size_t i = whole; i < Shape.size(); ++i)
                body(i, i - whole);
        }

        double modulus_, thickness_, area_;
    };
};

}}} // namespace tactnet::simulation
