// expect: an expression has no memory to be viewed; evaluate it into a matrix, or use copy_frame
// at-most: 1
#include <tactnet/eigen.hpp>

auto run(Eigen::Matrix<double, 28, 50, Eigen::RowMajor>& matrix) {
    return tactnet::view_frame(matrix.cast<float>());
}
