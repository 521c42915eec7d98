// expect: the frame would dangle
// at-most: 1
#include <tactnet/sensors.hpp>

void run() {
    static_cast<void>(tactnet::read_recording("hand.csv").as<tactnet::shape{28, 50, 1}>(5));
}
