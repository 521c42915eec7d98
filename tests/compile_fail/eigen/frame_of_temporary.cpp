// expect: a temporary matrix would be gone before its view; give it a name
// at-most: 1
#include <tactnet/eigen.hpp>

auto run() {
    return tactnet::view_frame(Eigen::Matrix<float, 28, 50, Eigen::RowMajor>());
}
