// expect: use of deleted function|deleted (constructor|function)
// expect: lasting_span
// at-most: 1
#include <tactnet/training.hpp>

#include <vector>

std::vector<std::size_t> labels();
const std::vector<float> values{1, 2};
const tactnet::labelled_features features{values, labels(), 2};
