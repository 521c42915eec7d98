// expect: view_frame: the size of the matrix is known at run time only; name the shape of the frame
// at-most: 1
#include <tactnet/eigen.hpp>

auto run(Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& matrix) {
    return tactnet::view_frame(matrix);
}
