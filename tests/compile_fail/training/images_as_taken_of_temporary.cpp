// expect: use of deleted function|deleted (constructor|function)
// expect: lasting_span
// at-most: 1
#include <tactnet/training.hpp>

#include <vector>

std::vector<std::uint8_t> recorded();
const auto taken = tactnet::images_as_taken::of<tactnet::shape{28, 50}, tactnet::shape{7, 13}>(recorded());
