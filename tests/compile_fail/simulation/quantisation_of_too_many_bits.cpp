// expect: quantisation: there must be 2 to 65536 levels, 1 to 16 bits
#include <tactnet/simulation.hpp>

using namespace tactnet::simulation;
scene<array<8, 12>, contact<winkler>, quantisation<64>> touched;
