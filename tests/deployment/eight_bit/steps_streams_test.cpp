#include <tactnet/operators.hpp>
#include <tactnet/quantisation/stream_calibration.hpp>
#include <tactnet/runtime/random.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <support/allocations.hpp>
#include <support/drawn_network.hpp>
#include <support/layers/whole_reference_streams.hpp>
#include <support/same_bits.hpp>
#include <type_traits>
#include <utility>
#include <vector>

// Streams in 8 bits: every bit against plain loops in whole numbers, and each output against the stream in
// single precision.

using namespace tactnet;
using support::drawn_network;
using support::same_bits;

namespace {

/// Samples, feature by feature.
template <class Network>
std::vector<float> samples(std::size_t count, std::uint32_t seed = 2) {
    random_stream random(seed, random_purposes::order, 0);
    std::vector<float> all(count * Network::input_shape.size());
    for (float& value : all)
        value = static_cast<float>(random.uniform(-2, 2));
    return all;
}
/// A sample, frame by frame.
template <class Network>
std::vector<float> recording_of(std::span<const float> all, std::size_t sample) {
    constexpr shape in = Network::input_shape;
    std::vector<float> frames(in.size());
    for (std::size_t i = 0; i < in.size(); ++i)
        frames[i % in.rows * in.channels + i / in.rows] = all[sample * in.size() + i];
    return frames;
}
template <class Stream>
std::vector<float> outputs_of(const Stream& stream, std::span<const float> recording) {
    std::vector<float> outputs(recording.size() / Stream::features * Stream::outputs);
    typename Stream::state memory;
    CHECK(stream.run(recording, memory, outputs) == recording.size() / Stream::features);
    return outputs;
}

/// The root mean square of the differences from single precision, in that of its outputs.
template <class Network>
double relative_error(const Network& network, const deployed_stream<Network, eight_bit>& stream,
                      std::span<const float> all) {
    const auto exact = deploy_stream(network);
    double squares = 0, errors = 0;
    for (std::size_t s = 0; s < all.size() / Network::input_shape.size(); ++s) {
        const auto recording = recording_of<Network>(all, s);
        const std::vector<float> expected = outputs_of(exact, recording),
                                 found = outputs_of(stream, recording);
        for (std::size_t i = 0; i < found.size(); ++i) {
            squares += std::pow(static_cast<double>(expected[i]), 2);
            errors += std::pow(static_cast<double>(expected[i] - found[i]), 2);
        }
    }
    return std::sqrt(errors / squares);
}

using classifier = network<shape{40, 1, 3}, gru<16>, last_frame, dense<4>, softmax>;
using tagger = network<shape{9, 1, 3}, named<"first", causal_conv1d<6, 3, 2>>, relu,
                       residual<sequence<causal_conv1d<6, 2>, hyperbolic_tangent>>, lstm<19>, dropout<20>,
                       residual<causal_conv1d<7, 1>, causal_conv1d<7, 2>>, silu, causal_conv1d<2, 1>>;
using wide = network<shape{4, 1, 37}, gru<70>, lstm<33>, causal_conv1d<41, 2>>;
using ends_in_bytes = network<shape{12, 1, 5}, dropout<10>, lstm<5>, causal_conv1d<3, 2>, sigmoid>;
using ends_in_states = network<shape{30, 1, 2}, causal_conv1d<9, 4, 3>, relu, relu, gru<5>, last_frame>;
using ends_in_relu =
    network<shape{15, 1, 4}, sequence<lstm<17>, last_frame>, dense<6>, relu, dense<5>, silu, dense<16>, relu>;

} // namespace

TEST_CASE_TEMPLATE("deployed_stream: in 8 bits, the bits of the plain reference", Network, classifier, tagger,
                   wide, ends_in_bytes, ends_in_states, ends_in_relu) {
    const auto network = drawn_network<Network>();
    const std::vector<float> all = samples<Network>(8);
    const auto stream = deploy_stream<eight_bit>(network, all);
    std::size_t different = 0, not_zero = 0;
    for (std::size_t s = 0; s < 8; ++s) {
        auto recording = recording_of<Network>(all, s);
        if (s == 7) // beyond all that calibration saw
            for (float& value : recording)
                value *= 30;
        const std::vector<float> found = outputs_of(stream, recording);
        different +=
            !same_bits(found, support::reference_stream_outputs<Network>(stream.folded(), recording));
        not_zero += static_cast<std::size_t>(
            std::count_if(found.begin(), found.end(), [](float v) { return v != 0; }));
    }
    CHECK(different == 0);
    CHECK(not_zero > 20);
}

TEST_CASE_TEMPLATE("deployed_stream: in 8 bits, close to single precision", Network, classifier, tagger, wide,
                   ends_in_bytes, ends_in_states, ends_in_relu) {
    const auto network = drawn_network<Network>();
    const std::vector<float> all = samples<Network>(16);
    const auto stream = deploy_stream<eight_bit>(network, all);
    const double error = relative_error(network, stream, all);
    // Measured: 0.62 % of the classifier, 0.21 to 0.41 % of the others.
    CHECK(error < 0.015);
    CHECK(error > 0);
    // Weights of instructions that multiply words have 16 bits, and narrow registers pad single precision
    // less than bytes: there, only a wide network is that much smaller.
    constexpr bool by_bytes = sizeof(kernels::byte_products<kernels::max_integer_lanes>::weight) == 1 &&
                              kernels::max_integer_lanes > 8;
    static_assert((!by_bytes && !std::is_same_v<Network, wide>) ||
                  deployed_stream<Network, eight_bit>::weight_bytes <
                      0.7 * deployed_stream<Network>::weight_bytes);
    static_assert(deployed_stream<Network, eight_bit>::state_bytes < deployed_stream<Network>::state_bytes);
}

TEST_CASE_TEMPLATE("deployed_stream: in 8 bits, features of unequal size are as exact as others", First,
                   gru<16>, causal_conv1d<16, 3>) {
    using net = network<shape{20, 1, 3}, First, gru<8>, last_frame, dense<3>>;
    auto network = drawn_network<net>();
    std::vector<float> all = samples<net>(16);
    const auto stream = deploy_stream<eight_bit>(network, all);
    // A feature is larger and its weights are smaller by a power of two: exactly the same network.
    constexpr float larger = 4096;
    const parameter weights = net::describe().front();
    for (std::size_t i = 0; i < weights.size; ++i)
        if (i / (weights.size / weights.extents[0] / 3) % 3 == 1)
            network.learnable_values()[weights.offset + i] /= larger;
    std::vector<float> of_unequal = all;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (i % 60 / 20 == 1)
            of_unequal[i] *= larger;
    const auto unequal = deploy_stream<eight_bit>(network, of_unequal);
    for (std::size_t s = 0; s < 16; ++s)
        CHECK(same_bits(outputs_of(unequal, recording_of<net>(of_unequal, s)),
                        outputs_of(stream, recording_of<net>(all, s))));
}

TEST_CASE_TEMPLATE("deployed_stream: in 8 bits, a feature that calibration never saw costs nothing", First,
                   gru<16>, causal_conv1d<16, 3>) {
    using net = network<shape{20, 1, 3}, First, gru<8>, last_frame, dense<3>>;
    const auto network = drawn_network<net>();
    std::vector<float> all = samples<net>(16);
    for (std::size_t i = 0; i < all.size(); ++i)
        if (i % 60 / 20 == 1)
            all[i] = 0;
    const auto stream = deploy_stream<eight_bit>(network, all);
    CHECK(stream.folded()[1] == std::min(stream.folded()[0], stream.folded()[2]));
    CHECK(relative_error(network, stream, all) < 0.015);
}

TEST_CASE("deployed_stream: in 8 bits, an error does not grow with the length of a recording") {
    using net = network<shape{2000, 1, 2}, gru<16>, lstm<8>, causal_conv1d<3, 1>>;
    const auto network = drawn_network<net>(5);
    const std::vector<float> all = samples<net>(1);
    const auto recording = recording_of<net>(all, 0);
    const std::vector<float> expected = outputs_of(deploy_stream(network), recording),
                             found = outputs_of(deploy_stream<eight_bit>(network, all), recording);
    const auto largest = [&](std::size_t first, std::size_t last) {
        double most = 0;
        for (std::size_t i = first * 3; i < last * 3; ++i)
            most = std::max(most, std::abs(static_cast<double>(expected[i] - found[i])));
        return most;
    };
    CHECK(largest(1000, 2000) < 1.5 * largest(0, 1000));
}

TEST_CASE("deployed_stream: in 8 bits, its folded numbers make it again, and others are rejected") {
    const auto stream = deploy_stream<eight_bit>(drawn_network<tagger>(), samples<tagger>(8));
    using stream_type = std::remove_const_t<decltype(stream)>;
    std::vector<float> folded(stream.folded().begin(), stream.folded().end());
    const auto made = [&] {
        return stream_type(std::span<const float, stream_type::folded_elements>(folded));
    };
    const auto recording = recording_of<tagger>(samples<tagger>(1, 7), 0);
    CHECK(same_bits(outputs_of(made(), recording), outputs_of(stream, recording)));

    const folded_layout layout = folded_layout_of<stream_type::view_type>();
    CHECK(layout.numbers == stream_type::folded_elements);
    std::vector<std::string> names;
    for (const folded_step& step : layout.steps)
        names.push_back(step.name);
    CHECK(names == std::vector<std::string>{"frame", "step1", "step2.main.step1", "step2.main.step2",
                                            "step2.main.step3", "step3.frame", "step3.state",
                                            "step4.main.step1", "step4.main.step2", "step4.skip.step1",
                                            "step5", "step6"});
    for (const folded_step& step : layout.steps)
        for (const folded_step::array& array : step.arrays)
            for (const float wrong :
                 {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
                const float kept = std::exchange(folded[array.offset], wrong);
                CHECK_THROWS_WITH_AS((void)made(), doctest::Contains(array.name.c_str()),
                                     std::invalid_argument);
                folded[array.offset] = kept;
            }
    folded[0] = 0;
    CHECK_THROWS_WITH_AS((void)made(), doctest::Contains("frame.step, element 0: expected a scale"),
                         std::invalid_argument);
    folded[0] = 1;

    // A sum is scaled by its larger range, not by the product of both.
    const folded_step& sum = layout.steps[4];
    const auto with_scales = [&](float input, float added, float output) {
        std::vector<float> kept = folded;
        folded[sum.find("input")->offset] = input, folded[sum.find("added")->offset] = added;
        folded[sum.find("output")->offset] = output;
        try {
            (void)made();
        } catch (const std::invalid_argument& e) {
            folded = kept;
            return std::string(e.what());
        }
        folded = kept;
        return std::string();
    };
    CHECK(with_scales(1e27F, 1e27F, 1e10F).empty());
    CHECK(with_scales(1e30F, 1e-30F, 1.2e-38F)
              .starts_with("deploy_stream: step2.main.step3.input, element 0: expected scales of which each "
                           "over that of "
                           "the output is a number of single precision, found"));
}

TEST_CASE("deployed_stream: in 8 bits, broken frames are reported and change nothing; others saturate") {
    const std::vector<float> all = samples<tagger>(4);
    const auto stream = deploy_stream<eight_bit>(drawn_network<tagger>(), all);
    const auto recording = recording_of<tagger>(all, 0);
    const std::vector<float> expected = outputs_of(stream, recording);
    std::vector<float> found(expected.size());
    decltype(stream)::state memory;
    for (std::size_t frame = 0; frame < 9; ++frame) {
        for (const float broken :
             {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
              -std::numeric_limits<float>::infinity()})
            for (std::size_t f = 0; f < 3; ++f) {
                std::array<float, 3> features{1, 2, 3};
                features[f] = broken;
                std::array<float, 2> to{-17, -18};
                CHECK(stream.step(features, memory, to) == frame_status::not_finite);
                CHECK(to == std::array<float, 2>{-17, -18});
                CHECK(!stream.classify(features, memory));
            }
        CHECK(stream.step(std::span(recording).subspan(frame * 3).first<3>(), memory,
                          std::span(found).subspan(frame * 2).first<2>()) == frame_status::ok);
    }
    CHECK(same_bits(found, expected));
    // The words hold four times the largest number of calibration.
    decltype(stream)::state one, other;
    std::array<float, 2> far{}, farther{};
    CHECK(stream.step(std::array{8.1F, -8.1F, 8.1F}, one, far) == frame_status::ok);
    CHECK(stream.step(std::array{3e38F, -3e38F, 3e38F}, other, farther) == frame_status::ok);
    CHECK(same_bits(far, farther));
}

TEST_CASE("deployed_stream: in 8 bits, calls use no heap and do not throw; a copy of the state is a point") {
    const std::vector<float> all = samples<wide>(4);
    const auto stream = deploy_stream<eight_bit>(drawn_network<wide>(), all);
    using stream_type = std::remove_const_t<decltype(stream)>;
    const auto recording = recording_of<wide>(all, 0);
    std::vector<float> outputs(4 * 41), again(4 * 41);
    stream_type::state memory;
    const std::size_t before = support::allocations();
    const std::size_t taken = stream.run(recording, memory, outputs);
    CHECK(support::allocations() == before);
    CHECK(taken == 4);
    stream_type::state other;
    CHECK(stream.run(std::span(recording).first(2 * 37), other, again) == 2);
    const auto point = other;
    for (std::size_t repeat = 0; repeat < 2; ++repeat) {
        other = point;
        CHECK(stream.run(std::span(recording).subspan(2 * 37), other, std::span(again).subspan(2 * 41)) == 2);
        CHECK(same_bits(again, outputs));
    }
    const std::span<const float, 37> frame(recording.data(), 37);
    static_assert(noexcept(stream.step(frame, memory, std::span<float, 41>(outputs.data(), 41))));
    static_assert(noexcept(stream.run(recording, memory, outputs)));
    static_assert(noexcept(stream.classify(frame, memory)));
    static_assert(std::is_trivially_copyable_v<stream_type::state>);
}

TEST_CASE("deployed_stream: in 8 bits, classify returns the largest logit and its probability") {
    const std::vector<float> all = samples<classifier>(4);
    const auto stream = deploy_stream<eight_bit>(drawn_network<classifier>(), all);
    decltype(stream)::state one, other;
    const auto recording = recording_of<classifier>(all, 3);
    for (std::size_t frame = 0; frame < 40; ++frame) {
        const auto features = std::span(recording).subspan(frame * 3).first<3>();
        std::array<float, 4> logits{};
        CHECK(stream.step(features, one, logits) == frame_status::ok);
        const auto found = stream.classify(features, other);
        REQUIRE(found);
        CHECK(found->index == classify_logits(logits, std::size_t{4})->index);
    }
}
