#include <tactnet/kernels/batch/lane_products.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <support/whole_numbers.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

template <std::size_t Rows, std::size_t Columns, matrix_layout Layout, class T>
void check_product() {
    const aligned_vector<T> matrix = support::whole_numbers<T>(Rows * Columns, 7919),
                            values = support::whole_numbers<T>(Columns * lanes<T>, 104729);
    std::vector<int> puts(Rows);
    lane_product<Rows, Columns, Layout>(
        matrix.data(), values.data(), [&](std::size_t row, const vector<T>& sum) {
            REQUIRE(row < Rows);
            ++puts[row];
            aligned_vector<T> found(lanes<T>), expected(lanes<T>);
            store(found.data(), sum);
            for (std::size_t c = 0; c < Columns; ++c)
                for (std::size_t lane = 0; lane < lanes<T>; ++lane)
                    expected[lane] +=
                        matrix[row * Layout.row + c * Layout.column] * values[c * lanes<T> + lane];
            CHECK(found == expected);
        });
    CHECK(std::all_of(puts.begin(), puts.end(), [](int n) { return n == 1; }));
}

} // namespace

TEST_CASE_TEMPLATE("lane_product: against plain loops, the matrix as it is and transposed", T, float,
                   double) {
    check_product<1, 1, matrix_layout{1, 1}, T>();
    check_product<1, 64, matrix_layout{64, 1}, T>();
    check_product<12, 5, matrix_layout{5, 1}, T>();
    check_product<13, 5, matrix_layout{5, 1}, T>();
    check_product<22, 280, matrix_layout{280, 1}, T>();
    check_product<280, 22, matrix_layout{1, 280}, T>();
    check_product<25, 3, matrix_layout{1, 25}, T>();
}
