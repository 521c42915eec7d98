// expect: would dangle
// at-most: 1
#include <tactnet/sensors.hpp>

void run() {
    static_cast<void>(tactnet::tekscan_map().places());
}
