#include "deployed_network.hpp"

#include <tactnet/io/parameters.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/networks/tactnet4.hpp>

#include <doctest/doctest.h>

#include <support/files/data_folder.hpp>

using namespace tactnet;

TEST_CASE("deployed: tactnet4, the published network gives the published logits" *
          doctest::test_suite("data")) {
    const auto network_file = support::find_data("published_tactnet4_14x25.safetensors");
    const auto golden_file = support::find_data("published_tactnet4_14x25_golden.safetensors");
    if (!network_file || !golden_file)
        return;
    using net_type = tactnet4<shape{14, 25}, 22>;
    constexpr std::size_t size = net_type::input_shape.size(), outputs = net_type::outputs;
    const safetensors weights = safetensors::read(*network_file), golden = safetensors::read(*golden_file);
    net_type net;
    load_parameters(net, weights);
    const std::vector<float> mean = weights.values<float>("input_mean");
    REQUIRE(mean.size() == size);
    const auto fast = deploy(net, std::span<const float, size>(mean.data(), size));

    const auto images = golden.values<std::uint8_t>("inputs");
    const auto expected = golden.values<float>("logits");
    const std::size_t count = images.size() / size;
    REQUIRE(count == 110);
    const auto layers = support::describe<net_type>();
    // Relative to the largest logit of an image: one near zero is a difference of large ones.
    double worst = 0;
    support::error_shares errors;
    std::size_t otherwise = 0;
    for (std::size_t i = 0; i < count; ++i) {
        std::vector<float> out(outputs);
        const std::span<const float> right(expected.data() + i * outputs, outputs);
        REQUIRE(fast.infer(tensor_view<const std::uint8_t, net_type::input_shape>(images.data() + i * size),
                           std::span<float, outputs>(out)) == frame_status::ok);
        double largest = 0, error = 0;
        for (std::size_t c = 0; c < outputs; ++c) {
            largest = std::max(largest, std::abs(static_cast<double>(right[c])));
            error = std::max(error, std::abs(static_cast<double>(out[c]) - static_cast<double>(right[c])));
        }
        worst = std::max(worst, error / largest);
        otherwise += first_largest(out) != first_largest(right);
        const std::vector<float> counts(images.begin() + static_cast<std::ptrdiff_t>(i * size),
                                        images.begin() + static_cast<std::ptrdiff_t>((i + 1) * size));
        errors.add(
            support::shares_of(out, support::bounded_outputs(layers, support::parameters_of(net),
                                                             support::bounded_input(counts, mean, 1))));
    }
    MESSAGE("largest relative distance of a logit: " << worst << "; " << errors);
    CHECK(worst < 1e-4);
    CHECK(otherwise == 0);
    CHECK(errors.good());
}
