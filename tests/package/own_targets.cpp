// The targets of the project itself have been linked, and no others.

#include <tactnet/eigen.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#if !defined(EIGEN_OF_THE_PROJECT) || (!defined(TACTNET_NO_SIMD) && !defined(XSIMD_OF_THE_PROJECT))
#error "the project's own targets are not taken"
#endif

int main() {
    Eigen::Matrix<float, 2, 3, Eigen::RowMajor> pressure;
    pressure << 1, 2, 3, 4, 5, 6;
    return tactnet::view_frame(pressure)(1, 0) == 4 ? 0 : 1;
}
