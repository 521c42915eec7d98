#pragma once

#include <tactnet/simulation/effect.hpp>

#include <algorithm>
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

}}} // namespace tactnet::simulation
