// expect: would dangle
// at-most: 1
#include <tactnet/tensor.hpp>

using map = tactnet::tensor<float, tactnet::shape{2, 3}>;

void run() {
    static_cast<void>(map().view());
}
