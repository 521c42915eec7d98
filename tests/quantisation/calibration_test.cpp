#include <tactnet/networks/tactnet4.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <deployment/eight_bit/networks.hpp>
#include <limits>
#include <stdexcept>

// The ranges of the maps, from images.

using namespace tactnet;

namespace {

using net = tactnet4<shape{14, 25}, 22>;
constexpr std::size_t size = net::input_shape.size();

const net& filled() {
    static const net network = [] {
        net n;
        support::fill(n, 60);
        return n;
    }();
    return network;
}
std::span<const float, size> mean() {
    static const std::vector<float> values = support::mean_for<net>(60);
    return std::span(values).first<size>();
}
eight_bit_calibration<net> on(std::span<const float> frames) {
    return {filled(), mean(), support::input_scale, frames};
}

/// By how much rounding changes outputs, as a part of the root of their mean square, where weights are merely
/// rounded; those that calibration chooses come nearer. A weight and a byte are off by a step / √12 each, in
/// steps of 1/127 and 1/255 of the largest number, which is at most four times the root of the mean square of
/// numbers such as these (evenly drawn weights: √3; sums of some dozens of them, near a normal distribution:
/// of a few thousand, one passes 3.5 to 4). Errors of layers are independent, so their squares add up.
double rounding_of(std::size_t layers) {
    constexpr double largest = 4;
    return std::sqrt(static_cast<double>(layers) / 12) * std::hypot(largest / 127, largest / 255);
}

/// Roots of mean squares over frames that calibration has not seen: of the outputs in single precision, and
/// of what those in 8 bits differ by.
struct sizes {
    double outputs = 0, differences = 0;
};
template <class Network>
sizes sizes_of(const Network& network, std::span<const float, Network::input_shape.size()> mean_frame,
               const support::byte_network<Network>& bytes) {
    const auto floats = deploy(network, mean_frame, support::input_scale);
    sizes result;
    constexpr std::size_t frames = 40;
    for (std::size_t i = 0; i < frames; ++i) {
        const auto counts = support::make_frame(Network::input_shape.size(), 9000 + i);
        const tensor_view<const std::uint8_t, Network::input_shape> frame(counts.data());
        std::array<float, Network::outputs> a, b;
        CHECK(floats.infer(frame, a) == frame_status::ok);
        CHECK(bytes.infer(frame, b) == frame_status::ok);
        for (std::size_t o = 0; o < a.size(); ++o) {
            const auto x = static_cast<double>(a[o]), y = static_cast<double>(b[o]);
            result.outputs += x * x, result.differences += (x - y) * (x - y);
        }
    }
    const auto root = [](double sum) { return std::sqrt(sum / (frames * Network::outputs)); };
    return {root(result.outputs), root(result.differences)};
}

} // namespace

TEST_CASE("eight_bit_calibration: outputs differ little from single precision, on other frames too") {
    const std::vector<float> frames = support::frames_for<net>(20, 61);
    const auto calibration = on(frames);
    const sizes found = sizes_of(filled(), mean(), support::byte_network<net>(calibration.folded()));
    MESSAGE("root of the mean square: " << found.differences << " of " << found.outputs);
    CHECK(found.differences < rounding_of(4) * found.outputs);
    CHECK(found.differences > 0);
    CHECK(calibration.output_error() < rounding_of(4) * found.outputs);
    CHECK(calibration.output_error() > 0);
}

TEST_CASE("eight_bit_calibration: sums and branches know what their maps stand for") {
    using branches =
        network<shape{9, 8, 2}, conv2d<8, 3>, relu, residual<sequence<conv2d<8, 3>>>,
                concatenation<sequence<conv2d<4, 1>>, sequence<conv2d<16, 3>, relu>>,
                residual<sequence<conv2d<12, 3>>, sequence<conv2d<12, 1>>>, relu, batch_norm, dense<5>>;
    branches n;
    support::fill(n, 70);
    const std::vector<float> mean_frame = support::mean_for<branches>(70);
    const support::byte_network<branches> bytes(support::calibrated(n, 70, 20).folded());
    const sizes found = sizes_of(n, std::span(mean_frame).first<branches::input_shape.size()>(), bytes);
    MESSAGE("root of the mean square: " << found.differences << " of " << found.outputs);
    CHECK(found.differences < rounding_of(8) * found.outputs); // with the batch norm
}

TEST_CASE(
    "eight_bit_calibration: the error that it tells is the error on its images, and no range does worse") {
    const std::vector<float> frames = support::frames_for<net>(5, 62);
    const auto calibration = on(frames);
    const auto error_of = [&](std::span<const float> folded) {
        const support::byte_network<net> bytes(
            folded.first<support::byte_network<net>::view_type::folded_elements>());
        const auto floats = deploy(filled(), mean(), support::input_scale);
        double sum = 0;
        for (std::size_t i = 0; i < 5; ++i) {
            const tensor_view<const float, net::input_shape> frame(frames.data() + i * size);
            std::array<float, net::outputs> a, b;
            CHECK(floats.infer(frame, a) == frame_status::ok);
            CHECK(bytes.infer(frame, b) == frame_status::ok);
            for (std::size_t o = 0; o < a.size(); ++o)
                sum += std::pow(static_cast<double>(a[o]) - static_cast<double>(b[o]), 2);
        }
        return std::sqrt(sum / (5 * net::outputs));
    };
    std::vector<float> folded(calibration.folded().begin(), calibration.folded().end());
    // Calibration has its outputs in single precision from plain loops, which sum in another order than the
    // deployed network. Both distances from the outputs in 8 bits differ by no more than these do from one
    // another: the triangle inequality, and 10⁻¹² for roots and sums in double precision.
    using view = support::byte_network<net>::view_type;
    std::vector<float> exact = folded;
    lowered_network<net, eight_bit>::fold(
        {filled().learnable_values().data(), filled().running_statistics().data(), filled().epsilon},
        exact.data() + view::steps_folded);
    const detail::activation_observer plain(calibration_graph_of<view>(), exact, support::input_scale,
                                            frames);
    REQUIRE(plain.outputs().size() == 5 * net::outputs);
    const auto floats = deploy(filled(), mean(), support::input_scale);
    double apart = 0;
    for (std::size_t i = 0; i < 5; ++i) {
        std::array<float, net::outputs> a;
        CHECK(floats.infer(tensor_view<const float, net::input_shape>(frames.data() + i * size), a) ==
              frame_status::ok);
        for (std::size_t o = 0; o < a.size(); ++o)
            apart += std::pow(
                static_cast<double>(a[o]) - static_cast<double>(plain.outputs()[i * net::outputs + o]), 2);
    }
    apart = std::sqrt(apart / (5 * net::outputs));
    CHECK(std::abs(error_of(folded) - calibration.output_error()) <= apart + 1e-12);
    CHECK(apart < 0.01 * calibration.output_error()); // or this would say nothing

    // What a map is written with, the next step reads with. Ranges far wider or narrower than those chosen
    // must not help.
    using steps = support::byte_network<net>::view_type::steps;
    std::vector<std::size_t> written, read;
    std::size_t at = support::byte_network<net>::view_type::steps_folded;
    [&]<std::size_t... I>(std::index_sequence<I...>) {
        (([&] {
             using step = typename steps::template at<I>;
             at += step::folded_elements;
             constexpr bool writes = step::arrays.has_output_range();
             if constexpr (writes)
                 written.push_back(at - 2);
             if constexpr (I > 0)
                 read.push_back(at - (writes ? 4 : 2));
         }()),
         ...);
    }(std::make_index_sequence<steps::size>{});
    REQUIRE(written.size() == calibration.maps());
    REQUIRE(read.size() == written.size());
    for (std::size_t m = 0; m < written.size(); ++m) {
        CHECK(folded[written[m]] == folded[read[m]]);
        for (const float factor : {0.25f, 0.4f, 2.5f, 5.0f}) {
            std::vector<float> changed = folded;
            changed[written[m]] *= factor, changed[read[m]] *= factor;
            CHECK(error_of(changed) > calibration.output_error());
        }
    }
}

TEST_CASE("eight_bit_calibration: one outlier in a map does not take the range of all others") {
    // The map holds numbers up to 0.97 × 29 that count, and 0.97 × 60 where nothing looks. Half of the full
    // range, the least that is tried, cuts off none that counts, and has the finest steps.
    using watched = network<shape{1, 4}, conv2d<2, 1>, dense<1>>;
    watched n;
    const std::array<float, 2 + 2 + 8 + 1> values{0.97f, 0.77f, 0, 0, /* [channel][column] */ 1, 1, 1, 0, 1,
                                                  1,     1,     0, 0};
    std::copy(values.begin(), values.end(), n.learnable_values().begin());
    std::vector<float> frames;
    for (int i = 0; i < 30; ++i)
        for (const float x : {static_cast<float>(i), static_cast<float>(29 - i), 7.0f, 60.0f})
            frames.push_back(x);
    const std::array<float, 4> zero{};
    const eight_bit_calibration<watched> calibration(n, zero, 1, std::span<const float>(frames));
    const float step =
        calibration.folded()[support::byte_network<watched>::view_type::steps_folded + 2 + 2 + 2 + 2];
    CHECK(step == map_range::of(0, 0.5 * static_cast<double>(0.97f * 60)).scale);
}

TEST_CASE("eight_bit_calibration: the same images give the same numbers, bytes as well as floats") {
    const std::vector<float> frames = support::frames_for<net>(4, 63);
    const std::vector<std::uint8_t> bytes(frames.begin(), frames.end());
    const auto first = on(frames), second = on(frames);
    CHECK(support::same_bits(first.folded(), second.folded()));
    CHECK(first.output_error() == second.output_error());
    const eight_bit_calibration<net> of_bytes(filled(), mean(), support::input_scale,
                                              std::span<const std::uint8_t>(bytes));
    CHECK(support::same_bits(first.folded(), of_bytes.folded()));
}

TEST_CASE("eight_bit_calibration: of many images some at even distances are used") {
    using small = network<shape{2, 3}, conv2d<2, 2>, relu, dense<2>>;
    small n;
    support::fill(n, 5);
    const std::array<float, 6> zero{};
    constexpr std::size_t most = eight_bit_calibration<small>::max_images;
    const std::vector<float> few = support::frames_for<small>(most, 3);
    std::vector<float> many;
    for (std::size_t i = 0; i < 3 * most; ++i) // of three, the first is taken
        for (std::size_t e = 0; e < 6; ++e)
            many.push_back(i % 3 == 0 ? few[i / 3 * 6 + e] : 255);
    const eight_bit_calibration<small> a(n, zero, 1, std::span<const float>(few)),
        b(n, zero, 1, std::span<const float>(many));
    CHECK(support::same_bits(a.folded(), b.folded()));
}

TEST_CASE("eight_bit_calibration: words hold whatever counts there are, in as many steps as fit") {
    using small = network<shape{2, 3}, conv2d<2, 2>, relu, dense<2>>;
    small n;
    support::fill(n, 5);
    const std::array<float, 6> mean_frame{0, 10, 20.5f, 0, 0, 250};
    for (const auto& [largest, expected] :
         {std::pair{200.0f, 128.0f}, {300.0f, 64.0f}, {4000.0f, 8.0f}, {3e5f, 0x1p-4f}, {1e20f, 0x1p-52f}}) {
        std::vector<float> frames = support::frames_for<small>(4, 3);
        frames[8] = largest;
        const eight_bit_calibration<small> calibration(n, mean_frame, 1, std::span<const float>(frames));
        const float steps = calibration.folded()[6], most = calibration.folded()[7];
        CHECK(steps == expected);
        CHECK(most * steps <= 32767);
        CHECK(most >= largest - 21);
        std::array<float, 2> out{};
        CHECK(support::byte_network<small>(calibration.folded())
                  .infer(tensor_view<const float, small::input_shape>(frames.data() + 6), out) ==
              frame_status::ok);
    }
}

TEST_CASE("eight_bit_calibration: no images, parts of one and broken ones are refused") {
    std::vector<float> frames = support::frames_for<net>(3, 64);
    const auto refused = [&](std::size_t counts, const char* text) {
        CHECK_THROWS_WITH_AS(static_cast<void>(on(std::span<const float>(frames).first(counts))),
                             doctest::Contains(text), std::invalid_argument);
    };
    refused(0, "expected one or more calibration images of 350 counts, found 0 counts");
    refused(size - 1, "found 349 counts");
    refused(2 * size + 1, "found 701 counts");
    for (const float broken :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
          -std::numeric_limits<float>::infinity(), 3e38f}) {
        frames[size + 17] = broken;
        refused(3 * size, "found number 1 of those taken broken");
    }
    frames[size + 17] = 1;
    CHECK_NOTHROW(static_cast<void>(on(frames)));
}

TEST_CASE("eight_bit_calibration: maps that hold nothing but zero are no difficulty") {
    using small = network<shape{4, 5}, conv2d<4, 3>, relu, residual<sequence<conv2d<4, 3>>>, relu, dense<2>>;
    small n; // all zeros
    std::fill(n.learnable_values().begin(), n.learnable_values().end(), 0.0f);
    n.for_each_parameter([](const parameter& p, auto values) {
        if (p.role == parameter_role::bias) // the last one is the dense layer's
            values.back() = 0.75f;
        if (p.role == parameter_role::bias && values.size() == 4)
            values.back() = 0;
    });
    const std::vector<float> frames = support::frames_for<small>(2, 3);
    const std::array<float, 20> zero{};
    const eight_bit_calibration<small> calibration(n, zero, 1, std::span<const float>(frames));
    const support::byte_network<small> bytes(calibration.folded());
    std::array<float, 2> out{};
    CHECK(bytes.infer(tensor_view<const float, small::input_shape>(frames.data()), out) == frame_status::ok);
    CHECK(out[0] == 0);
    CHECK(out[1] == 0.75f); // 2²⁸ units, each a power of two of it
}
