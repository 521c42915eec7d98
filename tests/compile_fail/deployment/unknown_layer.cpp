// expect: deploy: a layer of this kind has no lowering; has_lowering shows it
// expect: doubling
// at-most: 1
#include <tactnet/tactnet.hpp>

struct doubling : tactnet::relu {};

using net = tactnet::network<tactnet::shape{5, 4, 1}, tactnet::conv2d<2, 3>, doubling, tactnet::dense<3>>;
auto deployed = tactnet::deploy(net{});
