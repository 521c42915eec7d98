#include <tactnet/io/parameters.hpp>
#include <tactnet/io/safetensors.hpp>
#include <tactnet/networks/normalisation.hpp>
#include <tactnet/networks/tactnet4.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <support/files/data_folder.hpp>
#include <vector>

using namespace tactnet;

TEST_CASE("tactnet4: the published network gives the published logits" * doctest::test_suite("data")) {
    const auto network_file = support::find_data("published_tactnet4_14x25.safetensors");
    const auto golden_file = support::find_data("published_tactnet4_14x25_golden.safetensors");
    if (!network_file || !golden_file)
        return;
    constexpr shape size{14, 25, 1};
    using net_type = tactnet4<size, 22>;
    const safetensors weights = safetensors::read(*network_file), golden = safetensors::read(*golden_file);
    net_type net;
    load_parameters(net, weights);
    normalisation<size> normalise;
    const std::vector<float> mean = weights.values<float>("input_mean");
    std::copy(mean.begin(), mean.end(), normalise.mean.begin());

    const auto images = golden.values<std::uint8_t>("inputs");
    const auto expected = golden.values<float>("logits");
    const std::size_t count = images.size() / size.size();
    REQUIRE(count == 110);
    net_type::input_batch in(count);
    net_type::output_batch out(count);
    for (std::size_t i = 0; i < count; ++i)
        in.set(i, normalise.apply(std::span<const std::uint8_t, size.size()>(images.data() + i * size.size(),
                                                                             size.size())));
    thread_pool threads;
    net_type::workspace space;
    net.prepare(threads, space);
    net.infer(in, out, threads, space);

    // Relative to the largest logit of an image: one near zero is a difference of large ones.
    double worst = 0;
    std::size_t recognised = 0, otherwise = 0;
    for (std::size_t i = 0; i < count; ++i) {
        double largest = 0;
        std::size_t best = 0, expected_best = 0;
        for (std::size_t c = 0; c < 22; ++c) {
            largest = std::max(largest, std::abs(static_cast<double>(expected[i * 22 + c])));
            best = out(i, c) > out(i, best) ? c : best;
            expected_best = expected[i * 22 + c] > expected[i * 22 + expected_best] ? c : expected_best;
        }
        for (std::size_t c = 0; c < 22; ++c)
            worst = std::max(
                worst, std::abs(static_cast<double>(out(i, c)) - static_cast<double>(expected[i * 22 + c])) /
                           largest);
        recognised += best == i / 5;
        otherwise += best != expected_best;
    }
    MESSAGE("largest relative distance of a logit: " << worst << "; recognised " << recognised << " of "
                                                     << count);
    CHECK(worst < 1e-4);
    CHECK(otherwise == 0);
}
