// expect: view_frame: the matrix's size is known when running only; name the frame's shape
// at-most: 1
#include <tactnet/eigen.hpp>

auto run(Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& matrix) {
    return tactnet::view_frame(matrix);
}
