// expect: scene: an effect must have a noexcept apply.signal, moment.
// at-most: 1
#include <tactnet/simulation.hpp>

using namespace tactnet::simulation;
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
