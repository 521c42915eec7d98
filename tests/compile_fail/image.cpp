#include <tactnet/image.hpp>

#ifdef CASE_resize_to_nothing
// expect: resize: there must be at least one row, one column and one channel on both sides
// at-most: 1
void run(tactnet::tensor_view<const float, tactnet::shape{7, 13}> from,
         tactnet::tensor_view<float, tactnet::shape{0, 13}> to) {
    tactnet::resize<tactnet::shape{7, 13}, tactnet::shape{0, 13}>(from, to);
}
#endif

#ifdef CASE_transform_of_nothing
// expect: transform_image: there must be at least one row, one column and one channel
// at-most: 1
void run(tactnet::tensor_view<const float, tactnet::shape{7, 0}> from,
         tactnet::tensor_view<float, tactnet::shape{7, 0}> to) {
    tactnet::transform_image<tactnet::shape{7, 0}>({}, from, to);
}
#endif
