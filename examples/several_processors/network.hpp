#pragma once

#include <tactnet/tactnet.hpp>

// The network, which all units of the program know by this name. Its type is another in each, since it stands
// in the namespace of the instruction set that the unit is compiled for.
using net = tactnet::tactnet4<tactnet::shape{7, 13}, 22>;
