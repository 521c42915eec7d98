#pragma once

#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <limits>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace simulation {

/// How an object is pressed on the array: to a force, or to a depth.
struct pressing {
    enum class goal : bool { force, depth };

    goal until = goal::force;
    double amount = 10; ///< newtons, or metres below the first touch; 0 or less is no touch
    /// Of the object: E / (1 − ν²) in pascals, above 0. Infinite for a rigid one.
    double object_modulus = std::numeric_limits<double>::infinity();
    double object_thickness = 0.02; ///< metres of it that deform, where a model takes it for a layer

    /// One over the modulus: none for a rigid object, and for what is no modulus.
    [[nodiscard]] constexpr double object_softness() const {
        return object_modulus > 1e-30 ? 1 / object_modulus : 0;
    }
    /// Whether these are numbers that an object can have: a model is asked for no other.
    [[nodiscard]] constexpr bool possible() const {
        return amount == amount && object_modulus > 0 && object_thickness >= 0 &&
               object_thickness / object_modulus < std::numeric_limits<double>::infinity();
    }

    [[nodiscard]] static constexpr pressing to_force(double newtons) { return {goal::force, newtons}; }
    [[nodiscard]] static constexpr pressing to_depth(double metres) { return {goal::depth, metres}; }
};

/// How a contact was found.
struct contact_report {
    bool converged = true; ///< within the tolerance of its model; else the best that was found
    std::size_t iterations = 0;
    double force = 0;      ///< newtons
    double depth = 0;      ///< metres below the first touch
    std::size_t cells = 0; ///< of the surface grid, with pressure on them
};

/// A model of contact bound to a grid of square cells: pressures in pascals, none negative, from heights of
/// the object's underside in metres. A height that is infinite or NaN is no object. Its `solve` must end
/// after a bounded number of steps whatever the heights are.
template <class Bound, shape Shape>
concept bound_contact_model = requires(Bound bound, tensor_view<const float, Shape> heights,
                                       const pressing& press, signal<Shape> pressures) {
    { bound.solve(heights, press, pressures) }
    noexcept->std::same_as<contact_report>;
};

/// What every model has: a form bound to a shape.
template <class Model>
concept contact_model = std::copyable<Model> && requires {
    typename Model::template bound<shape{2, 2}>;
};

/// The first effect of each scene: the object meets the surface. `Model` is winkler, elastic_half_space or
/// bonded_layer, or one of your own: a struct of parameters with a form `bound<Shape>` that is made of the
/// model and the size of a cell in metres. A pressing that is not possible leaves no pressure, and a report
/// that says so.
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

} // namespace simulation
} // namespace TACTNET_ARCH
} // namespace tactnet
