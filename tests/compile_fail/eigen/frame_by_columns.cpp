// expect: its coefficients must lie row by row without gaps, and this one's lie column by column
// at-most: 1
#include <tactnet/eigen.hpp>

auto run(Eigen::Matrix<float, 28, 50>& matrix) {
    return tactnet::view_frame(matrix);
}
