// expect: scene: the bound form of an effect must have a constructor .effect, mounting.
#include <tactnet/simulation.hpp>

using namespace tactnet::simulation;
struct doubled {
    static constexpr stage place = stage::film;
    template <tactnet::shape Shape>
    struct bound {
        void apply(signal<Shape> values, const moment&) noexcept { values.data()[0] *= 2; }
    };
};
scene<array<8, 12>, contact<winkler>, doubled> touched;
