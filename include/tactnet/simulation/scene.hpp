#pragma once

#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/simulation/effect.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <cstddef>
#include <initializer_list>
#include <tuple>
#include <type_traits>
#include <utility>

// A scene is a type: an array, a contact, and the effects that matter. Effects that are not listed take no
// time, no memory and no code.

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// An array of tactels. The default pitch is that of the paper's sensor.
template <std::size_t Rows, std::size_t Columns>
struct array {
    static constexpr shape extents{Rows, Columns};
    static_assert(Rows > 0 && Columns > 0, "array: there must be at least one row and one column of tactels");

    double pitch = tekscan_6077::pitch; ///< metres from tactel to tactel, along both axes

    [[nodiscard]] constexpr double tactel_area() const { return pitch * pitch; }
};

namespace detail {

/// Whether effects are in the order of their stages.
[[nodiscard]] consteval bool in_order(std::initializer_list<stage> places) {
    return std::is_sorted(places.begin(), places.end());
}
[[nodiscard]] consteval bool begins_with_its_contact(std::initializer_list<stage> places) {
    return places.size() > 0 && *places.begin() == stage::contact &&
           std::count(places.begin(), places.end(), stage::contact) == 1;
}
/// The number of cells per side of a tactel that an effect asks for.
template <class Effect>
[[nodiscard]] consteval std::size_t cells_a_side() {
    if constexpr (requires { Effect::refinement; })
        return Effect::refinement;
    else
        return 1;
}

/// Whether a type in the list is an effect. If not, one sentence says what it lacks.
template <class Listed>
[[nodiscard]] consteval bool is_effect() {
    static_assert(placed_effect<Listed>,
                  "scene: an effect says where it happens: static constexpr stage place, as in "
                  "simulation/effect.hpp; placed_effect shows which one does not");
    if constexpr (placed_effect<Listed>)
        static_assert(
            bindable_effect<Listed>,
            "scene: an effect has a form that is bound to a shape, template <shape Shape> struct bound, "
            "and can be copied; bindable_effect shows which one does not");
    return effect<Listed>;
}
template <class Listed>
[[nodiscard]] consteval stage place_of() {
    if constexpr (placed_effect<Listed>)
        return Listed::place;
    else
        return stage::storage;
}

/// The shapes after each effect, beginning with that of the surface.
template <shape Surface, class... Effects>
struct shapes_along;
template <shape Surface>
struct shapes_along<Surface> {
    static constexpr std::array<shape, 1> all{Surface};
};
template <shape Surface, class Effect, class... Rest>
struct shapes_along<Surface, Effect, Rest...> {
    static constexpr auto all = [] {
        std::array<shape, sizeof...(Rest) + 2> result{Surface};
        const auto rest = shapes_along<output_shape<Effect, Surface>(), Rest...>::all;
        std::copy(rest.begin(), rest.end(), result.begin() + 1);
        return result;
    }();
};

} // namespace detail

/// Simulates touches of an array with the effects listed, of which the first is the contact:
///
///     using namespace tactnet::simulation;
///     scene<array<28, 50>, contact<winkler>, saturation, quantisation<8>> touch;
///
/// A frame uses no heap, unless an effect documents otherwise, and 4 bytes of stack per cell of the surface.
/// Each thread needs a scene of its own.
template <class Array, class... Effects>
class scene {
    static constexpr std::size_t count = sizeof...(Effects);
    // An assertion gives a better message than a constraint.
    static constexpr bool are_effects = (... && detail::is_effect<Effects>());
    static_assert(!are_effects || detail::begins_with_its_contact({detail::place_of<Effects>()...}),
                  "scene: the first effect, and no other, must be a contact<...>");
    static_assert(
        !are_effects || detail::in_order({detail::place_of<Effects>()...}),
        "scene: effects must be listed in the order of physics: contact, pad, tactel, film, circuit, "
        "converter, storage (see simulation/effect.hpp). An analogue effect cannot follow the converter.");

    static constexpr std::size_t refinement = (std::size_t{1} * ... * detail::cells_a_side<Effects>());
    static constexpr auto shapes =
        detail::shapes_along<shape{Array::extents.rows * refinement, Array::extents.columns* refinement},
                             Effects...>::all;
    // The first effect after mechanics, whose input is the clean frame.
    static constexpr std::size_t first_unclean =
        (std::size_t{0} + ... + std::size_t{detail::place_of<Effects>() <= stage::tactel});

public:
    /// The grid of object and contact: the tactels, or a finer grid with tactel_average.
    static constexpr shape surface = shapes.front();
    static constexpr shape tactels = shapes[first_unclean];
    static constexpr shape output = shapes.back();
    static_assert(tactels == Array::extents,
                  "scene: the mechanical effects must end with one value a tactel");

    /// The result of one frame.
    struct frames {
        tensor<float, tactels> clean;   ///< pascals on each tactel, before film and electronics
        tensor<float, output> measured; ///< after all effects: counts with a converter, else pascals
        contact_report contact;
    };

    /// Uses the default parameters.
    scene() : scene(Array{}, sensor_unit{}) {}
    /// Takes effects of the list with other parameters, in any order:
    ///
    ///     scene<…> touch({}, {.number = 7}, saturation{.limit = 20e3}, contact<winkler>{{.thickness =
    ///     1e-3}});
    template <class... Given>
    explicit scene(const Array& array, sensor_unit unit, const Given&... given)
        : array_(array),
          parameters_(chosen(given...)),
          effects_(bind(array, unit, parameters_, std::index_sequence_for<Effects...>{})) {}

    /// Metres between cells of the surface.
    [[nodiscard]] double cell() const { return array_.pitch / static_cast<double>(refinement); }
    [[nodiscard]] const Array& sensor() const { return array_; }

    /// Simulates a frame of an object with its underside at `heights`, in metres above any plane parallel to
    /// the array; infinite or NaN where there is no object. Effects with a memory continue from the last
    /// frame.
    void touch(tensor_view<const float, surface> heights, const pressing& press, const moment& now,
               frames& result) noexcept {
        tensor<float, surface> pressures;
        result.contact = std::get<0>(effects_).apply(heights, press, pressures.view());
        run<1>(pressures.view(), now, result);
    }
    /// Starts a new touch: forgets earlier frames.
    void reset() noexcept {
        std::apply([](auto&... bound) { (forget(bound), ...); }, effects_);
    }
    /// Starts a new touch on another sensor. Faster than a new scene, since effects that do not depend on the
    /// sensor are kept.
    void use(sensor_unit unit) {
        [&]<std::size_t... Index>(std::index_sequence<Index...>) {
            (change<Index>(unit), ...);
        }(std::index_sequence_for<Effects...>{});
    }

private:
    template <std::size_t Index>
    static constexpr shape shape_at = shapes[Index];
    template <std::size_t Index>
    using effect_at = std::tuple_element_t<Index, std::tuple<Effects...>>;
    template <std::size_t Index>
    using bound_at = typename effect_at<Index>::template bound<shape_at<Index>>;

    template <class Given>
    static constexpr bool listed_once = (std::size_t{std::is_same_v<Given, Effects>} + ...) == 1;
    template <class... Given>
    static std::tuple<Effects...> chosen(const Given&... given) {
        static_assert((... && listed_once<Given>),
                      "scene: parameters were given for an effect that is not listed, "
                      "or is listed twice");
        std::tuple<Effects...> effects;
        if constexpr ((... && listed_once<Given>)) // avoids further errors
            ((std::get<Given>(effects) = given), ...);
        return effects;
    }
    template <std::size_t... Index>
    static auto bind(const Array& array, sensor_unit unit, const std::tuple<Effects...>& effects,
                     std::index_sequence<Index...>) {
        static_assert((... && std::constructible_from<bound_at<Index>, const effect_at<Index>&, mounting>),
                      "scene: the bound form of an effect must have a constructor (effect, mounting)");
        return std::tuple<bound_at<Index>...>{
            bound_at<Index>(std::get<Index>(effects), mounted<Index>(array, unit))...};
    }
    template <std::size_t Index>
    static mounting mounted(const Array& array, sensor_unit unit) {
        constexpr double cells =
            static_cast<double>(shape_at<Index>.rows) / static_cast<double>(Array::extents.rows);
        return {array.pitch / cells, unit};
    }
    template <class Bound>
    static void forget(Bound& bound) noexcept {
        if constexpr (requires { bound.reset(); })
            bound.reset();
    }
    template <std::size_t Index>
    void change(sensor_unit unit) {
        if constexpr (requires { requires effect_at<Index>::same_in_every_sensor; })
            forget(std::get<Index>(effects_));
        else
            std::get<Index>(effects_) =
                bound_at<Index>(std::get<Index>(parameters_), mounted<Index>(array_, unit));
    }
    template <std::size_t Index>
    void run(tensor_view<float, shape_at<Index>> values, const moment& now, frames& result) noexcept {
        if constexpr (Index == first_unclean)
            std::copy(values.elements().begin(), values.elements().end(), result.clean.begin());
        if constexpr (Index == count) {
            std::copy(values.elements().begin(), values.elements().end(), result.measured.begin());
        } else if constexpr (shape_at<Index> == shape_at<Index + 1>) {
            static_assert(in_place_effect<bound_at<Index>, shape_at<Index>>,
                          "scene: an effect must have a noexcept apply(signal, moment)");
            std::get<Index>(effects_).apply(values, now);
            run<Index + 1>(values, now, result);
        } else {
            static_assert(
                reshaping_effect<bound_at<Index>, shape_at<Index>, shape_at<Index + 1>>,
                "scene: an effect that changes the shape must have a noexcept apply(from, to, moment)");
            tensor<float, shape_at<Index + 1>> next;
            std::get<Index>(effects_).apply(values, next.view(), now);
            run<Index + 1>(next.view(), now, result);
        }
    }

    Array array_;
    std::tuple<Effects...> parameters_;
    decltype(bind(Array{}, {}, {}, std::index_sequence_for<Effects...>{})) effects_;
};

}}} // namespace tactnet::simulation
