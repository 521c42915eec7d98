#include <tactnet/deployment.hpp>
#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/deployment/frame_ref.hpp>
#include <tactnet/networks.hpp>
#include <tactnet/quantisation.hpp>
#include <tactnet/tensor/tensor.hpp>
#include <tactnet/training/data/labelled_samples.hpp>
#include <tactnet/training/initialise.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

using namespace tactnet;

TEST_CASE("output_stage: channels come one after the other, without what stands between pixels") {
    using output = output_stage<single_precision, shape{1, 2, 3}, 4>;
    const std::array<float, 8> map{1, 2, 3, -1, 4, 5, 6, -1};
    std::array<float, 6> out{};
    CHECK(output::write(map.data(), out));
    CHECK(out == std::array<float, 6>{1, 4, 2, 5, 3, 6});
}

TEST_CASE("output_stage: a NaN or an infinity at any place is reported") {
    using output = output_stage<single_precision, shape{1, 1, 3}, 4>;
    constexpr float largest = std::numeric_limits<float>::max();
    std::array<float, 3> out{};
    std::array<float, 4> map{largest, -largest, 0, std::numeric_limits<float>::quiet_NaN()};
    CHECK(output::write(map.data(), out)); // what is no output does not count
    for (const float broken :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
          -std::numeric_limits<float>::infinity()})
        for (std::size_t place = 0; place < 3; ++place) {
            map = {1, 2, 3, 0};
            map[place] = broken;
            CHECK(!output::write(map.data(), out));
        }
}

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

namespace {

template <class Network>
void check_features() {
    constexpr std::size_t elements = Network::input_shape.size();
    model<Network> trained;
    initialise(trained.network, he_normal{}, 3);
    for (std::size_t c = 0; c < Network::outputs; ++c)
        trained.classes.push_back("object " + std::to_string(c));
    std::vector<float> weights, biases;
    trained.network.for_each_parameter([&](const parameter& p, std::span<const float> values) {
        if (p.name == "fc.weight")
            weights.assign(values.begin(), values.end());
        if (p.name == "fc.bias")
            biases.assign(values.begin(), values.end());
    });
    std::mt19937 random(1);
    std::vector<std::uint8_t> images(8 * elements);
    for (std::uint8_t& count : images)
        count = static_cast<std::uint8_t>(random() % 256);
    const auto single = deploy(trained);
    const auto eight = deploy<eight_bit>(trained, images);
    using single_type = decltype(single);
    using eight_type = decltype(eight);
    constexpr std::size_t features = std::remove_const_t<single_type>::features;
    static_assert(features == std::remove_const_t<eight_type>::features);
    REQUIRE(features * Network::outputs == weights.size());
    const auto memory = std::make_unique<typename std::remove_const_t<single_type>::workspace>();
    const auto eight_memory = std::make_unique<typename std::remove_const_t<eight_type>::workspace>();
    for (std::size_t i = 0; i < 8; ++i) {
        const auto frame = std::span(images).subspan(i * elements).template first<elements>();
        std::array<float, Network::outputs> logits;
        std::array<float, features> found, bytes;
        REQUIRE(single.infer(frame, logits, *memory) == frame_status::ok);
        single.read_features(*memory, found);
        // The last layer's products of what was read, whose sums are rounded `features` times.
        for (std::size_t o = 0; o < Network::outputs; ++o) {
            double sum = static_cast<double>(biases[o]), magnitude = std::abs(sum);
            for (std::size_t f = 0; f < features; ++f) {
                const double product =
                    static_cast<double>(weights[o * features + f]) * static_cast<double>(found[f]);
                sum += product, magnitude += std::abs(product);
            }
            CHECK(std::abs(static_cast<double>(logits[o]) - sum) <=
                  static_cast<double>(features + 1) * 0x1p-24 * magnitude);
        }
        // In 8 bits the same, in steps of a 255th of the largest among the calibration images.
        REQUIRE(eight.infer(frame, logits, *eight_memory) == frame_status::ok);
        eight.read_features(*eight_memory, bytes);
        double products = 0, squares = 0, difference = 0;
        for (std::size_t f = 0; f < features; ++f) {
            CHECK_UNARY((bytes[f] >= 0 && bytes[f] <= 255 && bytes[f] == std::floor(bytes[f])));
            products += static_cast<double>(found[f]) * static_cast<double>(bytes[f]);
            squares += static_cast<double>(bytes[f]) * static_cast<double>(bytes[f]);
        }
        const double step = products / squares;
        double norm = 0;
        for (std::size_t f = 0; f < features; ++f) {
            const double off = static_cast<double>(found[f]) - step * static_cast<double>(bytes[f]);
            difference += off * off;
            norm += static_cast<double>(found[f]) * static_cast<double>(found[f]);
        }
        CHECK(difference < 0.01 * norm); // 8 bits in every layer: within a tenth of the length
    }
}

} // namespace

TEST_CASE("read_features: what the last layer reads, in single precision and in 8 bits") {
    check_features<tactnet4<shape{7, 13}, 5>>();
    check_features<tactnet6<shape{28, 50}, 22>>();
    check_features<network<shape{6, 9}, conv2d<5, 3>, relu, conv2d<7, 3>, relu, max_pool<2>, dense<3>>>();
}

TEST_CASE("features: none for a network whose only layer reads the frame") {
    static_assert(deployed<network<shape{3, 4}, dense<2>>>::features == 0);
    static_assert(deployed<tactnet6<shape{28, 50}, 22>>::features == 256);
}
