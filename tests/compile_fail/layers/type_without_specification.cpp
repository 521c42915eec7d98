// expect: network: each entry of a list must be a layer specification, with name, numbered, costs.const shape&. and a template layer<class, shape>; layer_specification shows what is missing
// expect: .Spec::name. (is|would be) invalid
// at-most: 1
// characters: 16000
#include <tactnet/networks.hpp>

using net = tactnet::network<tactnet::shape{28, 50}, tactnet::conv2d<8, 5>, int, tactnet::dense<22>>;
static_assert(net::outputs == 22);
const net made;
