#include <tactnet/eigen/frames.hpp>

#include <doctest/doctest.h>

#include <stdexcept>
#include <vector>

using namespace tactnet;

TEST_CASE("map_frame: a decoded frame is a matrix in place, and a matrix a frame") {
    const std::vector<float> cells{1, 2, 3, 4, 5, 6};
    const frame_view frame{7, 0.5, 2, 3, cells};
    const auto matrix = map_frame(frame);
    CHECK(matrix.data() == cells.data());
    CHECK(matrix.rows() == 2);
    CHECK(matrix(1, 0) == frame(1, 0));

    const frame_view back = view_sensor_frame(matrix, 8, 0.75);
    CHECK(back.number == 8);
    CHECK(back.seconds == 0.75);
    CHECK(back.rows == 2);
    CHECK(back.columns == 3);
    CHECK(back.cells.data() == cells.data());
    CHECK(back.as<shape{2, 3}>());

    const frame_view first = view_sensor_frame(matrix);
    CHECK(first.number == 0);
    CHECK(!first.seconds);
}

TEST_CASE("map_frame: cells that are not rows x columns, and rows with gaps, are refused") {
    const std::vector<float> cells(5);
    CHECK_THROWS_WITH_AS((void)map_frame(frame_view{1, {}, 2, 3, cells}),
                         "frame: expected 2 x 3 cells, found 5", std::invalid_argument);
    Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> wide(3, 8);
    CHECK_THROWS_AS((void)view_sensor_frame(wide.leftCols(5)), std::invalid_argument);
    CHECK(view_sensor_frame(wide).cells.size() == 24);
}
