#pragma once

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/eight_bit/layout_of.hpp>

// The number format of 8 bits: deployed<Network, eight_bit>, its files and its exported headers. To make such
// a network from a trained one, include tactnet/quantisation.hpp.
