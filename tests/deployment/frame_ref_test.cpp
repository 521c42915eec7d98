#include <tactnet/deployment/frame_ref.hpp>
#include <tactnet/tensor/tensor.hpp>
#include <tactnet/training/data/labelled_samples.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape size{2, 3}, deep{2, 3, 2};

template <class Frame, shape Shape = size>
constexpr bool converts = std::is_convertible_v<Frame, frame_ref<Shape>>;
static_assert(converts<std::array<std::uint8_t, 6>> && converts<const std::array<float, 6>&>);
static_assert(converts<float (&)[6]> && converts<const std::uint8_t (&)[2][3]>);
static_assert(converts<float (&)[2][2][3], deep> && converts<float (&)[12], deep>);
static_assert(converts<std::span<const float, 6>> && converts<std::span<std::uint8_t, 6>>);
static_assert(converts<tensor<float, size>> && converts<tensor_view<std::uint8_t, size>> &&
              converts<tensor_view<const float, size>>);
static_assert(std::is_same_v<decltype(try_view<size>(std::declval<std::vector<float>&>()))::value_type,
                             tensor_view<float, size>>);
// Another number of elements, another shape, another type, or a size that is known at run time.
static_assert(!converts<std::array<float, 5>> && !converts<float (&)[7]> && !converts<std::span<float, 7>>);
static_assert(!converts<float (&)[3][2]> && !converts<float (&)[2][2][3]> &&
              !converts<tensor<float, shape{3, 2}>>);
static_assert(!converts<tensor<float, shape{6, 1}>> && !converts<tensor_view<float, deep>>);
static_assert(!converts<std::array<double, 6>> && !converts<std::array<std::int8_t, 6>> && !converts<float*>);
static_assert(!converts<std::vector<float>> && !converts<std::span<const float>> && !converts<std::string>);
static_assert(!converts<std::optional<tensor_view<const float, size>>>);

template <class Frames>
constexpr bool holds_frames = std::is_convertible_v<Frames, frames_ref<size>>;
static_assert(holds_frames<std::vector<float>> && holds_frames<std::span<const std::uint8_t>> &&
              holds_frames<std::array<float, 6>>);
static_assert(holds_frames<std::vector<std::array<float, 6>>> &&
              holds_frames<std::vector<tensor<float, size>>> && holds_frames<labelled_images>);
static_assert(!holds_frames<std::vector<double>> && !holds_frames<std::vector<std::array<float, 5>>> &&
              !holds_frames<std::vector<tensor<float, shape{3, 2}>>>);
// Views lie one after the other, but what they view does not.
static_assert(!holds_frames<std::vector<tensor_view<const float, size>>> &&
              !holds_frames<std::vector<std::span<const float, 6>>>);

template <shape Shape>
std::vector<float> values_of(frame_ref<Shape> frame) {
    return frame.visit([](auto view) { return std::vector<float>(view.data(), view.data() + view.size()); });
}
template <shape Shape>
bool is_counts(frame_ref<Shape> frame) {
    return frame.visit([]<class T>(tensor_view<const T, Shape>) { return std::is_same_v<T, std::uint8_t>; });
}
const std::vector<float> expected{1, 2, 3, 4, 5, 6};

} // namespace

TEST_CASE("frame_ref: it refers to the elements of what it was made from, as bytes or floats") {
    const std::array<std::uint8_t, 6> counts{1, 2, 3, 4, 5, 6};
    float rows[2][3] = {{1, 2, 3}, {4, 5, 6}};
    tensor<float, size> whole;
    for (std::size_t e = 0; e < 6; ++e)
        whole.data()[e] = expected[e];
    CHECK(values_of<size>(counts) == expected);
    CHECK(values_of<size>(std::span(counts)) == expected);
    CHECK(values_of<size>(rows) == expected);
    CHECK(values_of<size>(whole) == expected);
    CHECK(values_of<size>(whole.view()) == expected);
    CHECK(is_counts<size>(counts));
    CHECK_FALSE(is_counts<size>(rows));
    const frame_ref<size> frame(rows);
    rows[1][2] = 7;
    CHECK(values_of(frame).back() == 7);
}

TEST_CASE("frames_ref: frames lie one after the other, whatever holds them") {
    const std::vector<std::uint8_t> counts{0, 0, 0, 0, 0, 0, 1, 2, 3, 4, 5, 6};
    const auto check = [](const frames_ref<size>& frames, bool bytes) {
        REQUIRE(frames.size() == 2);
        CHECK(frames.elements() == 12);
        CHECK(values_of(frames[0]) == std::vector<float>(6));
        CHECK(values_of(frames[1]) == expected);
        CHECK(is_counts(frames[1]) == bytes);
    };
    check(counts, true);
    check(std::vector<float>(counts.begin(), counts.end()), false);
    check(std::vector<std::array<float, 6>>{{}, {1, 2, 3, 4, 5, 6}}, false);
    std::array<tensor<std::uint8_t, size>, 2> tensors{}; // with a gap after each, for alignment
    static_assert(sizeof(tensors[0]) > 6);
    for (std::size_t e = 0; e < 6; ++e)
        tensors[1].data()[e] = counts[6 + e];
    check(tensors, true);
    const std::vector<std::size_t> labels{0, 1};
    check(labelled_images{counts, labels, 2}, true);
    // The functions that take them notice one that is cut short.
    CHECK(frames_ref<size>(std::vector<float>(13)).size() == 2);
    CHECK(frames_ref<size>(std::vector<float>(13)).elements() == 13);
}
