#include "pliers.hpp" // a frame of the sensor

#include <tactnet/io/deployed_file.hpp>
#include <tactnet/tactnet.hpp>

#include <iostream>

using net = tactnet::tactnet4<tactnet::shape{14, 25}, 22>; // 14 × 25 tactels, 22 kinds of objects
static_assert(net::multiply_adds == 134'768);              // the cost is known at compile time

int main() {
    const auto network = tactnet::load_deployed<net>("examples/recognise/simulated.safetensors");
    if (const auto found = network.classify(pliers))
        std::cout << found->name << ", probability " << found->probability << '\n';
}
