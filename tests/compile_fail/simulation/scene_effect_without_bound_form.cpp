// expect: scene: an effect has a form that is bound to a shape, template <shape Shape> struct bound, and can be copied; bindable_effect shows which one does not
// expect: bindable_effect<doubled>|Effect = doubled|'doubled' does not satisfy 'bindable_effect'
// at-most: 2
#include <tactnet/simulation.hpp>

using namespace tactnet::simulation;
struct doubled {
    static constexpr stage place = stage::film;
};
scene<array<8, 12>, contact<winkler>, doubled> touched;
