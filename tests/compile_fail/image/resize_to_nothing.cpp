// expect: resize: there must be at least one row, one column and one channel on both sides
// at-most: 1
#include <tactnet/image.hpp>

void run(tactnet::tensor_view<const float, tactnet::shape{7, 13}> from,
         tactnet::tensor_view<float, tactnet::shape{0, 13}> to) {
    tactnet::resize<tactnet::shape{7, 13}, tactnet::shape{0, 13}>(from, to);
}
