#include <tactnet/deployment.hpp>
#include <tactnet/eigen/elements.hpp>
#include <tactnet/eigen/frames.hpp>
#include <tactnet/networks/tactnet4.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <string>
#include <support/allocations.hpp>
#include <support/error_of.hpp>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape small{4, 6}, deep{4, 6, 3};
template <class T>
using dynamic = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <class F>
std::string message_of(F&& call) {
    return support::error_of<std::invalid_argument>(call);
}

template <class M>
void number(M& matrix) {
    for (Eigen::Index r = 0; r < matrix.rows(); ++r)
        for (Eigen::Index c = 0; c < matrix.cols(); ++c)
            matrix(r, c) = static_cast<typename M::Scalar>(10 * r + c);
}

} // namespace

TEST_CASE_TEMPLATE("frames: a matrix of fixed size is viewed where it lies", T, std::uint8_t, float, double) {
    frame_matrix<T, small> matrix;
    number(matrix);
    const auto view = view_frame(matrix);
    static_assert(std::is_same_v<decltype(view), const tensor_view<T, small>>);
    static_assert(noexcept(view_frame(matrix))&& noexcept(view_frame<small>(matrix)));
    CHECK(view.data() == matrix.data());
    CHECK(view(2, 5) == T(25));
    view(3, 1) = T(7);
    CHECK(matrix(3, 1) == T(7));

    const auto& constant = matrix;
    static_assert(std::is_same_v<decltype(view_frame(constant)), tensor_view<const T, small>>);
    CHECK(view_frame(constant).data() == matrix.data());

    // And back, to the same memory.
    const auto mapped = map_frame(view);
    static_assert(std::is_same_v<decltype(mapped), const Eigen::Map<frame_matrix<T, small>>>);
    CHECK(mapped.data() == matrix.data());
    CHECK((mapped.array() == matrix.array()).all());
    static_assert(
        std::is_same_v<decltype(map_frame(view_frame(constant))), Eigen::Map<const frame_matrix<T, small>>>);
}

TEST_CASE_TEMPLATE("frames: sizes and strides known when running only are looked at when called", T,
                   std::uint8_t, float) {
    dynamic<T> matrix(4, 6);
    number(matrix);
    CHECK(view_frame<small>(matrix).data() == matrix.data());
    CHECK(try_view_frame<small>(matrix)->data() == matrix.data());
    static_assert(noexcept(try_view_frame<small>(matrix)) && !noexcept(view_frame<small>(matrix)));

    dynamic<T> other(5, 6);
    CHECK_FALSE(try_view_frame<small>(other));
    CHECK(message_of([&] { (void)view_frame<small>(other); }) ==
          "frame: expected a matrix of 4 x 6 stored row by row without gaps, found 5 x 6");
    other.resize(6, 4);
    CHECK_FALSE(try_view_frame<small>(other));

    dynamic<T> wide(4, 7);
    CHECK_FALSE(try_view_frame<small>(wide.leftCols(6)));
    CHECK(message_of([&] { (void)view_frame<small>(wide.leftCols(6)); }) ==
          "frame: expected a matrix of 4 x 6 stored row by row without gaps, found 4 x 6 with gaps between "
          "its rows or coefficients");
    dynamic<T> tall(9, 6);
    CHECK(view_frame<small>(tall.middleRows(2, 4)).data() == &tall(2, 0));

    // One of both sizes may be known.
    Eigen::Matrix<T, Eigen::Dynamic, 6, Eigen::RowMajor> half(4, 6);
    CHECK(view_frame<small>(half).data() == half.data());
    half.resize(3, 6);
    CHECK_FALSE(try_view_frame<small>(half));
}

TEST_CASE("frames: references, maps, arrays and rows of a matrix of frames") {
    frame_matrix<float, small> matrix;
    number(matrix);
    const auto through = [](const Eigen::Ref<const frame_matrix<float, small>>& m) {
        return view_frame<small>(m).data();
    };
    CHECK(through(matrix) == matrix.data());
    CHECK(view_frame(Eigen::Map<frame_matrix<float, small>>(matrix.data())).data() == matrix.data());
    Eigen::Array<float, 4, 6, Eigen::RowMajor> array;
    CHECK(view_frame(array).data() == array.data());

    Eigen::Matrix<std::uint8_t, Eigen::Dynamic, 24, Eigen::RowMajor> frames(5, 24);
    CHECK(view_frame<small>(frames.row(3)).data() == &frames(3, 0));
    Eigen::VectorXf vector(24);
    CHECK(view_frame<small>(vector).data() == vector.data());
    CHECK_FALSE(try_view_frame<small>(vector.head(23)));

    // A single column.
    Eigen::Matrix<float, 4, 1> column;
    const auto view = view_frame(column);
    static_assert(decltype(view)::extents == shape{4, 1});
    CHECK(map_frame(view).data() == column.data());
}

TEST_CASE("frames: planes of several channels lie one below the other") {
    tensor<float, deep> maps;
    std::iota(maps.begin(), maps.end(), 0.0f);
    const auto stacked = map_frame(maps);
    static_assert(decltype(stacked)::RowsAtCompileTime == 12 && decltype(stacked)::ColsAtCompileTime == 6);
    CHECK(stacked.data() == maps.data());
    const auto planes = map_planes(maps);
    static_assert(planes.size() == 3);
    for (std::size_t channel = 0; channel < 3; ++channel) {
        CHECK(planes[channel].data() == maps.data() + 24 * channel);
        for (std::size_t r = 0; r < 4; ++r)
            for (std::size_t c = 0; c < 6; ++c) {
                const auto row = static_cast<Eigen::Index>(r), column = static_cast<Eigen::Index>(c);
                REQUIRE(planes[channel](row, column) == maps(r, c, channel));
                REQUIRE(stacked(static_cast<Eigen::Index>(4 * channel) + row, column) == maps(r, c, channel));
            }
    }
    map_planes(maps)[2].setConstant(-1);
    CHECK(maps(0, 0, 2) == -1);
    CHECK(maps(3, 5, 1) == 47);

    const auto back = view_frame<deep>(stacked);
    static_assert(std::is_same_v<decltype(back), const tensor_view<const float, deep>>);
    CHECK(back.data() == maps.data());
    const auto& constant = maps;
    static_assert(std::is_same_v<decltype(map_planes(constant)),
                                 std::array<Eigen::Map<const frame_matrix<float, small>>, 3>>);
}

TEST_CASE("frames: what cannot be viewed is copied") {
    Eigen::Matrix<float, 4, 6> columns;
    number(columns);
    frame_matrix<float, small> rows = columns;
    const auto equals = [&](const tensor<float, small>& frame) {
        return std::memcmp(frame.data(), rows.data(), sizeof(float) * small.size()) == 0;
    };
    CHECK(equals(copy_frame<small>(columns)));
    CHECK(equals(copy_frame<small>(Eigen::MatrixXf(columns))));
    CHECK(equals(copy_frame<small>(Eigen::ArrayXXf(columns.array()))));
    CHECK(equals(copy_frame<small>(columns.cast<double>().cast<float>())));
    CHECK(equals(copy_frame<small>(Eigen::MatrixXf(columns.transpose()).transpose())));
    CHECK(equals(copy_frame<small>(Eigen::MatrixXf(columns).block(0, 0, 4, 6))));
    CHECK(equals(copy_frame<small>(columns * Eigen::Matrix<float, 6, 6>::Identity())));
    const Eigen::VectorXf vector = Eigen::Map<Eigen::VectorXf>(rows.data(), 24);
    CHECK(equals(copy_frame<small>(vector)));
    CHECK(equals(copy_frame<small>(vector.transpose())));
    CHECK(message_of([] { (void)copy_frame<small>(Eigen::MatrixXf(6, 4)); }) ==
          "frame: expected a matrix of 4 x 6, found 6 x 4");
}

TEST_CASE("frames: a network recognises an Eigen matrix with the same bits, without the heap") {
    using net = tactnet4<shape{7, 13}, 5>;
    net network;
    float value = 0;
    for (float& parameter : network.learnable_values().first(net::parameters))
        parameter = 0.1f * std::sin(value += 1);
    const auto fast = deploy(network);

    std::array<std::uint8_t, 7 * 13> counts;
    for (std::size_t i = 0; i < counts.size(); ++i)
        counts[i] = static_cast<std::uint8_t>(i * 37);
    std::array<float, 5> expected;
    REQUIRE(fast.infer(counts, expected) == frame_status::ok);
    REQUIRE(std::any_of(expected.begin(), expected.end(), [](float logit) { return logit != 0; }));

    const auto matrix = frame_matrix<std::uint8_t, net::input_shape>::Map(counts.data()).eval();
    const frame_matrix<float, net::input_shape> floats = matrix.cast<float>();
    const dynamic<float> any_size = floats;
    const Eigen::MatrixXf by_columns = floats;
    Eigen::Vector<float, 5> logits;
    const auto recognised = [&](auto frame) {
        logits.setZero();
        const std::size_t before = support::allocations();
        const bool whole = fast.infer(frame, view_elements(logits)) == frame_status::ok;
        return whole && support::allocations() == before &&
               std::memcmp(logits.data(), expected.data(), sizeof expected) == 0;
    };
    CHECK(recognised(view_frame(matrix)));
    CHECK(recognised(view_frame(floats)));
    CHECK(recognised(*try_view_frame<net::input_shape>(any_size)));
    const auto copy = copy_frame<net::input_shape>(by_columns);
    CHECK(recognised(copy.view()));
}

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
