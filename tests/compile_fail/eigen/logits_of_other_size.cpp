// expect: elements: the matrix has more or fewer coefficients than asked for; has_elements shows those of the matrix
// expect: Found = 21; .*Expected = 22|has_elements<21UL, 22UL>
// at-most: 1
#include <tactnet/eigen.hpp>

auto run(Eigen::Vector<float, 21>& logits) {
    return tactnet::view_elements<22>(logits);
}
