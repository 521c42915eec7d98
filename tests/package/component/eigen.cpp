// What a program whose frames are Eigen matrices writes first.

#include <tactnet/eigen.hpp>

int main() {
    Eigen::Matrix<float, 2, 3, Eigen::RowMajor> pressure;
    pressure << 1, 2, 3, 4, 5, 6;
    const auto frame = tactnet::view_frame(pressure);
    return frame.data() == pressure.data() && frame(1, 0) == 4 ? 0 : 1;
}
