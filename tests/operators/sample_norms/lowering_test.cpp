#include "../../deployment/deployed_network.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <stdexcept>

// Norms with moments of each frame, deployed, at sizes that fill no vector and at sizes that do.

using namespace tactnet;

namespace {

constexpr norm_over frame = norm_over::frame, channels = norm_over::channels;

} // namespace

TEST_CASE_TEMPLATE("deployed: a norm of the frame, and of maps that fill vectors or do not", Norm,
                   group_norm<1>, instance_norm, layer_norm<frame>, layer_norm<channels>) {
    using of_frame = network<shape{9, 11, 3}, Norm>;
    using filled = network<shape{9, 11, 3}, conv2d<16, 3>, Norm>;
    using padded = network<shape{5, 7, 2}, conv2d<20, 3>, Norm, relu>;
    CHECK(support::errors_of<of_frame>(66, 5));
    CHECK(support::errors_of<filled>(67, 5));
    CHECK(support::errors_of<padded>(68, 5));
}

TEST_CASE("deployed: group and instance norms, of the frame, after convolutions and pools, with ReLU") {
    using net = network<shape{9, 11, 3}, instance_norm, conv2d<12, 3>, group_norm<4>, relu, max_pool<2>,
                        conv2d<20, 3>, relu, group_norm<5>, conv2d<16, 3>, group_norm<1>, relu, dense<4>>;
    CHECK(support::errors_of<net>(61, 5));
}

TEST_CASE("deployed: layer norms of frames and of the channels of each pixel, with ReLU") {
    using net =
        network<shape{7, 6, 3}, layer_norm<channels>, conv2d<20, 3>, layer_norm<frame>, relu, conv2d<33, 3>,
                layer_norm<channels>, relu, conv2d<8, 3>, layer_norm<channels>, dense<5>, layer_norm<frame>>;
    CHECK(support::errors_of<net>(62, 5));
}

TEST_CASE("deployed: norms inside residual blocks and beside other branches") {
    using main = sequence<conv2d<16, 3>, group_norm<4>, relu, conv2d<16, 3>>;
    using net = network<shape{6, 7}, conv2d<16, 3>, residual<main>, instance_norm, relu,
                        concatenation<sequence<conv2d<8, 1>, group_norm<2>>, identity_layer>, dense<3>>;
    CHECK(support::errors_of<net>(63, 5));
}

TEST_CASE("deployed: a frame without contact, and one far from zero, stay within the bound") {
    using net = network<shape{7, 13}, conv2d<6, 3, 1, padding::valid>, group_norm<2>, conv2d<5, 3>,
                        layer_norm<channels>, dense<3>>;
    net trained;
    support::fill(trained, 64);
    const auto fast = deploy(trained);
    const auto layers = support::describe<net>();
    const auto parameters = support::parameters_of(trained);
    for (const float level : {0.0F, 255.0F, 1e6F})
        for (const float step : {0.0F, 1.0F}) {
            CAPTURE(level);
            CAPTURE(step);
            std::vector<float> counts(net::input_shape.size(), level), out(net::outputs);
            for (std::size_t i = 0; i < counts.size(); ++i)
                counts[i] += step * static_cast<float>(i * 37 % 11);
            REQUIRE(fast.infer(tensor_view<const float, net::input_shape>(counts.data()),
                               std::span<float, net::outputs>(out)) == frame_status::ok);
            const auto expected =
                support::bounded_outputs(layers, parameters, support::bounded_input(counts, {}, 1));
            for (std::size_t o = 0; o < out.size(); ++o)
                CHECK(support::within(static_cast<double>(out[o]), expected[o]));
        }
}

TEST_CASE("deployed: the input limit keeps squares finite, and larger counts are rejected") {
    using net = network<shape{3, 4, 2}, group_norm<1>, dense<2>>;
    net trained;
    support::fill(trained, 65);
    const auto fast = deploy(trained);
    std::vector<float> counts(net::input_shape.size()), out(net::outputs);
    const auto infer = [&](float largest) {
        for (std::size_t i = 0; i < counts.size(); ++i)
            counts[i] = i % 2 == 0 ? largest : -largest;
        return fast.infer(tensor_view<const float, net::input_shape>(counts.data()),
                          std::span<float, net::outputs>(out));
    };
    CHECK(infer(1e13F) == frame_status::ok);
    CHECK(std::isfinite(out[0]));
    CHECK(infer(1e30F) == frame_status::not_finite);
}

TEST_CASE("deployed: a norm of samples without an epsilon above zero is rejected") {
    network<shape{3, 4, 2}, group_norm<1>, dense<2>> net;
    for (const double epsilon : {0.0, -1.0, 1e-60}) {
        net.epsilon = epsilon;
        CHECK_THROWS_AS((void)deploy(net), std::invalid_argument);
    }
}
