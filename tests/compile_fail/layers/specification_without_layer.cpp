// expect: network: each entry of a list must be a layer specification, with name, numbered, costs.const shape&. and a template layer<class, shape>; layer_specification shows what is missing
// expect: layer
// at-most: 1
// characters: 16000
#include <tactnet/networks.hpp>

struct unbound {
    static constexpr std::string_view name = "unbound";
    static constexpr bool numbered = true;
    static constexpr tactnet::layer_costs costs(const tactnet::shape& input) { return {.output = input}; }
};
using net = tactnet::network<tactnet::shape{28, 50}, tactnet::conv2d<8, 5>,
                             tactnet::residual<tactnet::sequence<unbound>>, tactnet::dense<22>>;
static_assert(net::outputs == 22);
const net made;
