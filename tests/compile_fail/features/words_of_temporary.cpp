// expect: would dangle
// at-most: 1
#include <tactnet/features.hpp>

#include <vector>

void run() {
    static_cast<void>(tactnet::bag_of_words<2, 3>(std::vector<float>(4)).words());
}
