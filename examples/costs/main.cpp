// tactnet_costs: what the paper's networks cost at each of the 836 sizes from 7 x 13 to 28 x 50, found when
// this is compiled, without making a layer. Writes CSV to standard output, a line per network and size, which
// docs/pictures/source/costs.gnuplot draws. Copy it, and put in networks of your own.

#include <tactnet/networks/costs.hpp>
#include <tactnet/networks/tactnet4.hpp>
#include <tactnet/networks/tactnet6.hpp>
#include <tactnet/networks/tactresnet.hpp>

#include <cstddef>
#include <cstdio>

namespace {

using tactnet::shape;

constexpr std::size_t classes = 22;

struct tactnet4_sizes {
    template <shape Input>
    using at = tactnet::tactnet4<Input, classes>;
};
struct tactnet6_sizes {
    template <shape Input>
    using at = tactnet::tactnet6<Input, classes>;
};
struct economical_sizes {
    template <shape Input>
    using at = tactnet::tactnet6_economical<Input, classes>;
};
struct tactresnet_sizes {
    template <shape Input>
    using at = tactnet::tactresnet<Input, classes>;
};

template <class Sizes>
void write(const char* network) {
    static constexpr auto table = tactnet::costs_at_sizes<Sizes>();
    for (std::size_t place = 0; place < table.size; ++place) {
        const shape image = table.size_of(place);
        const tactnet::network_costs& c = table.costs[place];
        std::printf("%s,%zu,%zu,%zu,%zu,%zu,%zu,%zu\n", network, image.rows, image.columns, c.parameters,
                    c.multiply_adds, c.multiply_adds_on_pixels, c.parameter_bytes, c.activation_bytes);
    }
}

} // namespace

int main() {
    std::puts("network,rows,columns,parameters,multiply_adds,multiply_adds_on_pixels,parameter_bytes,"
              "activation_bytes");
    write<tactnet4_sizes>("tactnet4");
    write<tactnet6_sizes>("tactnet6");
    write<economical_sizes>("tactnet6-economical");
    write<tactresnet_sizes>("tactresnet");
    return std::fflush(stdout) == 0 ? 0 : 1;
}
