// expect: frame: the matrix has another size than the frame; matrix_has_size shows its rows, its columns, expected rows
// expect: Rows = 28; int Columns = 49; int ExpectedRows = 28; int ExpectedColumns = 50|matrix_has_size<28, 49, 28, 50>
// at-most: 1
#include <tactnet/eigen.hpp>

auto run(Eigen::Matrix<float, 28, 49, Eigen::RowMajor>& matrix) {
    return tactnet::view_frame<tactnet::shape{28, 50}>(matrix);
}
