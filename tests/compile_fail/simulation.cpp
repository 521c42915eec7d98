#include <tactnet/simulation.hpp>

using namespace tactnet::simulation;

#ifdef CASE_contact_of_no_model
// expect: contact: its model must be a struct of parameters with a class template bound<shape>
// at-most: 3
struct spring {
    double stiffness = 1;
};
scene<array<8, 12>, contact<spring>> touched;

#elif defined(CASE_quantisation_of_too_many_bits)
// expect: quantisation: there must be 2 to 65536 levels, 1 to 16 bits
// at-most: 3
scene<array<8, 12>, contact<winkler>, quantisation<64>> touched;

#elif defined(CASE_scene_analogue_after_converter)
// expect: effects must be listed in the order of physics: contact, pad, tactel, film, circuit, converter, storage
// expect: An analogue effect cannot follow the converter
scene<array<8, 12>, contact<winkler>, quantisation<8>, noise> touched;

#elif defined(CASE_scene_effect_may_throw)
// expect: scene: an effect must have a noexcept apply.signal, moment.
struct doubled {
    static constexpr stage place = stage::film;
    template <tactnet::shape Shape>
    struct bound {
        bound(const doubled&, const mounting&) {}
        void apply(signal<Shape> values, const moment&) { values.data()[0] *= 2; }
    };
};
using touched = scene<array<8, 12>, contact<winkler>, doubled>;
void look(touched& some, touched::frames& result) {
    simulate(some, {}, {}, result);
}

#elif defined(CASE_scene_effect_not_constructible)
// expect: scene: the bound form of an effect must have a constructor .effect, mounting.
// at-most: 2
struct doubled {
    static constexpr stage place = stage::film;
    template <tactnet::shape Shape>
    struct bound {
        void apply(signal<Shape> values, const moment&) noexcept { values.data()[0] *= 2; }
    };
};
scene<array<8, 12>, contact<winkler>, doubled> touched;

#elif defined(CASE_scene_effect_without_bound_form)
// expect: scene: an effect has a form that is bound to a shape, template <shape Shape> struct bound, and can be copied; bindable_effect shows which one does not
// expect: bindable_effect<doubled>|Effect = doubled|'doubled' does not satisfy 'bindable_effect'
// at-most: 2
struct doubled {
    static constexpr stage place = stage::film;
};
scene<array<8, 12>, contact<winkler>, doubled> touched;

#elif defined(CASE_scene_effect_without_place)
// expect: scene: an effect says where it happens: static constexpr stage place, as in simulation/effect.hpp; placed_effect shows which one does not
// expect: placed_effect<doubled>|Effect = doubled|'doubled' does not satisfy 'placed_effect'
struct doubled {
    template <tactnet::shape Shape>
    struct bound {
        bound(const doubled&, const mounting&) {}
        void apply(signal<Shape> values, const moment&) noexcept { values.data()[0] *= 2; }
    };
};
scene<array<8, 12>, contact<winkler>, doubled, quantisation<8>> touched;

#elif defined(CASE_scene_no_contact)
// expect: scene: the first effect, and no other, must be a contact
scene<array<8, 12>, noise, quantisation<8>> touched;

#elif defined(CASE_scene_two_contacts)
// expect: scene: the first effect, and no other, must be a contact
scene<array<8, 12>, contact<winkler>, contact<bonded_layer>, noise> touched;

#elif defined(CASE_scene_unlisted_parameters)
// expect: scene: parameters were given for an effect that is not listed, or is listed twice
scene<array<8, 12>, contact<winkler>, noise> touched({}, {}, saturation{});
#endif
