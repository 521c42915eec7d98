#include <tactnet/operators.hpp>
#include <tactnet/quantisation/stream_calibration.hpp>
#include <tactnet/runtime/random.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

using namespace tactnet;

namespace {

using net = network<shape{40, 1, 3}, causal_conv1d<6, 2>, relu, gru<16>, last_frame, dense<4>>;

net drawn() {
    net network;
    random_stream random(1, random_purposes::order, 0);
    for (float& value : network.learnable_values())
        value = static_cast<float>(random.uniform(-0.5, 0.5));
    return network;
}
std::vector<float> drawn_samples(std::size_t count) {
    random_stream random(2, random_purposes::order, 0);
    std::vector<float> all(count * net::input_shape.size());
    for (float& value : all)
        value = static_cast<float>(random.uniform(-2, 2));
    return all;
}

} // namespace

TEST_CASE("stream_calibration: ranges are those of the sequences") {
    std::vector<float> all = drawn_samples(3);
    all[77] = -5; // the largest magnitude of the second feature
    const stream_calibration<net> found(drawn(), all);
    const folded_layout layout = folded_layout_of<deployed_stream<net, eight_bit>::view_type>();
    const auto range = [&](std::size_t step, const char* name) {
        return map_range::read(&found.folded()[layout.steps[step].find(name)->offset]);
    };
    CHECK(found.folded()[1] == 5 * 4 / 32767.0F);
    for (const std::size_t feature : {std::size_t{0}, std::size_t{2}}) {
        CHECK(found.folded()[feature] <= 2 * 4 / 32767.0F);
        CHECK(found.folded()[feature] > 1.9F * 4 / 32767.0F);
    }
    CHECK(range(1, "input").scale == 1);
    CHECK(range(1, "input").zero_point == 0);
    CHECK(range(1, "output").zero_point == 0); // with the ReLU
    CHECK(range(2, "input").scale == range(1, "output").scale);
    CHECK(range(3, "input").scale == 1 / 127.0F);
    CHECK(range(3, "input").zero_point == 128);
}

namespace {

/// How many of 5 000 frames get another class in 8 bits than in single precision.
template <class Network>
std::size_t other_classes(const Network& network, std::span<const float> sequences) {
    const auto floats = deploy_stream(network);
    const auto bytes = deploy_stream<eight_bit>(network, sequences);
    typename decltype(floats)::state float_memory;
    typename decltype(bytes)::state byte_memory;
    random_stream random(5, random_purposes::order, 0);
    std::size_t others = 0;
    for (int frame = 0; frame < 5000; ++frame) {
        std::array<float, Network::input_shape.channels> features;
        for (float& feature : features)
            feature = static_cast<float>(random.uniform(-1, 1));
        others +=
            floats.classify(features, float_memory)->index != bytes.classify(features, byte_memory)->index;
    }
    return others;
}
template <class Network>
void check_outlier() {
    Network network;
    random_stream random(3, random_purposes::order, 0);
    for (float& value : network.learnable_values())
        value = static_cast<float>(random.uniform(-0.5, 0.5));
    std::vector<float> all(24'000);
    for (float& value : all)
        value = static_cast<float>(random.uniform(-1, 1));
    const std::size_t before = other_classes(network, all);
    for (const float outlier : {1e3F, -1e6F, 30.0F}) {
        all[7777] = outlier;
        CAPTURE(outlier);
        CHECK(other_classes(network, all) <= 2 * before + 10);
    }
}

} // namespace

TEST_CASE("stream_calibration: one number far beyond all others does not take their steps") {
    check_outlier<network<shape{40, 1, 4}, gru<8>, last_frame, dense<6>>>(); // 470 of 5 000, without one 6
    check_outlier<network<shape{40, 1, 4}, causal_conv1d<8, 3>, relu, causal_conv1d<8, 2, 2>, relu,
                          last_frame, dense<6>>>();
}

TEST_CASE("stream_calibration: each sequence begins anew") {
    using pairs = network<shape{4, 1, 1}, causal_conv1d<1, 2>, relu, gru<2>>;
    pairs network;
    for (float& value : network.learnable_values())
        value = 0.5F;
    // Half of a frame, half of the one before, and a bias of a half: 2.5 if the second sequence went on.
    const std::vector<float> all{0, 0, 0, 2, 2, 0, 0, 0};
    const stream_calibration<pairs> found(network, all);
    const folded_layout layout = folded_layout_of<deployed_stream<pairs, eight_bit>::view_type>();
    CHECK(map_range::read(&found.folded()[layout.steps[1].find("output")->offset]).scale == 1.5F / 255);
}

TEST_CASE("stream_calibration: wrong calibration sequences and parameters are refused") {
    auto network = drawn();
    std::vector<float> all = drawn_samples(2);
    const auto message = [&](std::size_t numbers) -> std::string {
        try {
            (void)deploy_stream<eight_bit>(network, std::span<const float>(all).first(numbers));
        } catch (const std::invalid_argument& e) {
            return e.what();
        }
        return "";
    };
    CHECK(message(240) == "");
    CHECK(message(0) ==
          "deploy_stream: expected one or more calibration sequences of 120 numbers, found 0 numbers");
    CHECK(message(130).ends_with("found 130 numbers"));
    all[5] = std::numeric_limits<float>::quiet_NaN();
    CHECK(message(240).starts_with("deploy_stream: expected calibration sequences that give finite numbers"));
    all[5] = 0;
    network.learnable_values()[3] = std::numeric_limits<float>::infinity();
    CHECK(message(240).starts_with("deploy_stream: expected parameters that give finite numbers"));
}

TEST_CASE("stream_calibration: infinite numbers between layers are refused") {
    using hidden = network<shape{4, 1, 1}, causal_conv1d<1, 2>, hyperbolic_tangent, gru<2>>;
    hidden network;
    network.learnable_values()[0] = 1e20F;
    const std::vector<float> all{0, 1e25F, 0, 0};
    CHECK_THROWS_WITH_AS(stream_calibration<hidden>(network, all),
                         "deploy_stream: expected parameters and sequences that give finite numbers up to "
                         "1e30, found inf",
                         std::invalid_argument);
}

TEST_CASE("stream_calibration: sequences of zeros calibrate, too") {
    const auto network = drawn();
    const std::vector<float> all(net::input_shape.size());
    std::vector<float> expected(40 * 4), found(40 * 4);
    const auto exact = deploy_stream(network);
    const auto in_8_bits = deploy_stream<eight_bit>(network, all);
    decltype(exact)::state one;
    decltype(in_8_bits)::state other;
    CHECK(exact.run(all, one, expected) == 40);
    CHECK(in_8_bits.run(all, other, found) == 40);
    for (std::size_t i = 0; i < found.size(); ++i)
        CHECK(std::abs(found[i] - expected[i]) < 0.02F);
}
