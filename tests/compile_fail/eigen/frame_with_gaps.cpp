// expect: its coefficients must lie row by row without gaps, and this one's lie column by column .Eigen's default. or with gaps
// at-most: 1
#include <tactnet/eigen.hpp>

auto run(Eigen::Matrix<float, 28, 50, Eigen::RowMajor>& matrix) {
    return tactnet::view_frame(matrix.leftCols<49>());
}
