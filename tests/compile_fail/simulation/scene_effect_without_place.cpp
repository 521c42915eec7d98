// expect: scene: an effect says where it happens: static constexpr stage place, as in simulation/effect.hpp; placed_effect shows which one does not
// expect: placed_effect<doubled>|Effect = doubled|'doubled' does not satisfy 'placed_effect'
// at-most: 1
#include <tactnet/simulation.hpp>

using namespace tactnet::simulation;
struct doubled {
    template <tactnet::shape Shape>
    struct bound {
        bound(const doubled&, const mounting&) {}
        void apply(signal<Shape> values, const moment&) noexcept { values.data()[0] *= 2; }
    };
};
scene<array<8, 12>, contact<winkler>, doubled, quantisation<8>> touched;
