#include <tactnet/deployment.hpp>
#include <tactnet/networks.hpp>
#include <tactnet/quantisation.hpp>
#include <tactnet/training/initialise.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <vector>

using namespace tactnet;

namespace {

template <class Network>
void check_features() {
    constexpr std::size_t size = Network::input_shape.size();
    model<Network> trained;
    initialise(trained.network, he_normal{}, 3);
    for (std::size_t c = 0; c < Network::outputs; ++c)
        trained.classes.push_back("object");
    std::vector<float> weights, biases;
    trained.network.for_each_parameter([&](const parameter& p, std::span<const float> values) {
        if (p.name == "fc.weight")
            weights.assign(values.begin(), values.end());
        if (p.name == "fc.bias")
            biases.assign(values.begin(), values.end());
    });
    std::mt19937 random(1);
    std::vector<std::uint8_t> images(8 * size);
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
        const auto frame = std::span(images).subspan(i * size).template first<size>();
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
