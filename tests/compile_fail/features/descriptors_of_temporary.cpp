// expect: would dangle
// at-most: 1
#include <tactnet/features.hpp>

void run() {
    static_cast<void>(tactnet::dense_surf<tactnet::shape{14, 25, 1}>().descriptors());
}
