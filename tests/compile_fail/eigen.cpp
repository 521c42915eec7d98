#include <tactnet/eigen.hpp>

#ifdef CASE_features_of_other_size
// expect: view_features: the matrix has more or fewer columns than features asked for; has_columns shows those
// expect: Found = 1399; .*Expected = 1400|has_columns<1399UL, 1400UL>
auto run(Eigen::Matrix<float, Eigen::Dynamic, 1399, Eigen::RowMajor>& samples) {
    return tactnet::view_features<1400>(samples);
}

#elif defined(CASE_frame_by_columns)
// expect: its coefficients must lie row by row without gaps, and this one's lie column by column
auto run(Eigen::Matrix<float, 28, 50>& matrix) {
    return tactnet::view_frame(matrix);
}

#elif defined(CASE_frame_of_expression)
// expect: an expression has no memory to be viewed; evaluate it into a matrix, or use copy_frame
auto run(Eigen::Matrix<double, 28, 50, Eigen::RowMajor>& matrix) {
    return tactnet::view_frame(matrix.cast<float>());
}

#elif defined(CASE_frame_of_other_size)
// expect: frame: the matrix has another size than the frame; matrix_has_size shows its rows, its columns, expected rows
// expect: Rows = 28; int Columns = 49; int ExpectedRows = 28; int ExpectedColumns = 50|matrix_has_size<28, 49, 28, 50>
auto run(Eigen::Matrix<float, 28, 49, Eigen::RowMajor>& matrix) {
    return tactnet::view_frame<tactnet::shape{28, 50}>(matrix);
}

#elif defined(CASE_frame_of_temporary)
// expect: a temporary matrix would be gone before its view; give it a name
auto run() {
    return tactnet::view_frame(Eigen::Matrix<float, 28, 50, Eigen::RowMajor>());
}

#elif defined(CASE_frame_of_unknown_size)
// expect: view_frame: the size of the matrix is known at run time only; name the shape of the frame
auto run(Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>& matrix) {
    return tactnet::view_frame(matrix);
}

#elif defined(CASE_frame_with_gaps)
// expect: its coefficients must lie row by row without gaps, and this one's lie column by column .Eigen's default. or with gaps
auto run(Eigen::Matrix<float, 28, 50, Eigen::RowMajor>& matrix) {
    return tactnet::view_frame(matrix.leftCols<49>());
}

#elif defined(CASE_logits_of_other_size)
// expect: elements: the matrix has more or fewer coefficients than asked for; has_elements shows those of the matrix
// expect: Found = 21; .*Expected = 22|has_elements<21UL, 22UL>
auto run(Eigen::Vector<float, 21>& logits) {
    return tactnet::view_elements<22>(logits);
}
#endif
