// expect: view_features: the matrix has more or fewer columns than features asked for; has_columns shows those
// expect: Found = 1399; .*Expected = 1400|has_columns<1399UL, 1400UL>
// at-most: 1
#include <tactnet/eigen.hpp>

auto run(Eigen::Matrix<float, Eigen::Dynamic, 1399, Eigen::RowMajor>& samples) {
    return tactnet::view_features<1400>(samples);
}
