#pragma once

#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <limits>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// Presses an object on the array to a force or to a depth.
struct pressing {
    enum class goal : bool { force, depth };

    goal until = goal::force;
    double amount = 10; ///< newtons, or metres below the first touch; 0 or less is no touch
    /// E / (1 − ν²) of the object in pascals, above 0; infinite if it is rigid.
    double object_modulus = std::numeric_limits<double>::infinity();
    double object_thickness = 0.02; ///< metres that deform, in models of the object as a layer

    /// One over the modulus; 0 for rigid objects and invalid moduli.
    [[nodiscard]] constexpr double object_softness() const {
        return object_modulus > 1e-30 ? 1 / object_modulus : 0;
    }
    /// Whether the parameters are physically possible. Models only get such ones.
    [[nodiscard]] constexpr bool possible() const {
        return amount == amount && object_modulus > 0 && object_thickness >= 0 &&
               object_thickness / object_modulus < std::numeric_limits<double>::infinity();
    }

    [[nodiscard]] static constexpr pressing to_force(double newtons) { return {goal::force, newtons}; }
    [[nodiscard]] static constexpr pressing to_depth(double metres) { return {goal::depth, metres}; }
};

/// The result of solving a contact.
struct contact_report {
    bool converged = true; ///< within the tolerance of the model, else the best found
    std::size_t iterations = 0;
    double force = 0;      ///< newtons
    double depth = 0;      ///< metres below the first touch
    std::size_t cells = 0; ///< number of surface cells with pressure
};

/// A contact model bound to a grid of square cells. `solve` computes nonnegative pressures in pascals from
/// heights of the underside of the object in metres; infinite or NaN where there is no object. It ends after
/// a bounded number of steps for any heights.
template <class Bound, shape Shape>
concept bound_contact_model = requires(Bound bound, tensor_view<const float, Shape> heights,
                                       const pressing& press, signal<Shape> pressures) {
    { bound.solve(heights, press, pressures) } noexcept -> std::same_as<contact_report>;
};

/// A contact model has a class template `bound<shape>`.
template <class Model>
concept contact_model = std::copyable<Model> && requires {
    typename Model::template bound<shape{2, 2}>;
};

/// The first effect of each scene: the contact of object and surface. `Model` is winkler, elastic_half_space,
/// bonded_layer or your own: a struct of parameters with a class template `bound<Shape>`, constructed from
/// the model and the size of a cell in metres. An impossible pressing gives no pressure, and has not
/// converged.
template <class Model>
struct contact {
    static_assert(contact_model<Model>,
                  "contact: its model must be a struct of parameters with a class template bound<shape>");
    static constexpr stage place = stage::contact;
    static constexpr bool same_in_every_sensor = true;

    Model model{};

    template <shape Shape>
    class bound {
    public:
        static_assert(bound_contact_model<typename Model::template bound<Shape>, Shape>,
                      "contact: its model must find pressures from heights (see bound_contact_model)");

        bound(const contact& effect, const mounting& where) : solver_(effect.model, where.cell) {}
        contact_report apply(tensor_view<const float, Shape> heights, const pressing& press,
                             signal<Shape> pressures) noexcept {
            if (!press.possible()) {
                std::fill_n(pressures.data(), Shape.size(), 0.0f);
                return {.converged = false};
            }
            return solver_.solve(heights, press, pressures);
        }

    private:
        typename Model::template bound<Shape> solver_;
    };
};

// The fast contact model: independent springs. It is the limit of a compressible elastic layer on a rigid
// base that is thin compared with the contact (Johnson, Contact Mechanics, 1985, section 4.3).

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
