// A frame as an Eigen matrix.

#include <tactnet/eigen.hpp>

#include <cstdio>

int main() {
    Eigen::Matrix<float, 2, 3, Eigen::RowMajor> pressure;
    pressure << 1, 2, 3, 4, 5, 6;
    const auto frame = tactnet::view_frame(pressure);
    if (frame.data() != pressure.data() || frame(1, 0) != 4)
        return 1;
    std::puts("tactnet takes Eigen's matrices");
}
