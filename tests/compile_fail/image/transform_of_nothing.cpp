// expect: transform_image: there must be at least one row, one column and one channel
// at-most: 1
#include <tactnet/image.hpp>

void run(tactnet::tensor_view<const float, tactnet::shape{7, 0}> from,
         tactnet::tensor_view<float, tactnet::shape{7, 0}> to) {
    tactnet::transform_image<tactnet::shape{7, 0}>({}, from, to);
}
