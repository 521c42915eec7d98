// expect: lasting_range
// at-most: 1
#include <tactnet/tensor.hpp>

#include <vector>

void run() {
    static_cast<void>(tactnet::try_view<tactnet::shape{2, 3}>(std::vector<float>(6)));
}
