// expect: use of deleted function|deleted (constructor|function)
// expect: lasting_span
// at-most: 1
#include <tactnet/training.hpp>

#include <vector>

struct data_set {
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels;
};
data_set load();
const std::vector<std::size_t> labels{0, 1};
const tactnet::labelled_images images{load().pixels, labels, 2};
