#include "deployed_network.hpp"

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/deployment/reflection_average.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <support/allocations.hpp>
#include <utility>

using namespace tactnet;

namespace {

constexpr shape size{9, 11};
using net = network<size, conv2d<4, 3>, batch_norm, relu, max_pool<2>, dense<5>>;
using average = reflection_average<deployed<net>::view_type>;
using logits = std::array<float, net::outputs>;

static_assert(noexcept(std::declval<const average&>().infer(
    std::declval<tensor_view<const std::uint8_t, size>>(), std::declval<std::span<float, net::outputs>>(),
    std::declval<average::workspace&>())));

deployed<net> some_network() {
    net network;
    support::fill(network, 8);
    std::array<float, size.size()> mean{}; // not symmetric, as no mean image is
    for (std::size_t e = 0; e < size.size(); ++e)
        mean[e] = static_cast<float>(e % 7);
    return deploy(network, mean, 0.02f);
}

template <class Count>
void check_average() {
    const deployed<net> network = some_network();
    const average both_ways(network.view());
    const auto memory = std::make_unique<average::workspace>();
    const auto counts = support::make_frame(size.size(), 3);
    std::array<Count, size.size()> frame{}, turned{};
    for (std::size_t e = 0; e < size.size(); ++e)
        frame[e] = static_cast<Count>(counts[e]);

    std::array<logits, 4> outputs_per_reflection;
    logits found, again;
    REQUIRE(both_ways.infer(tensor_view<const Count, size>(frame.data()), found, *memory) ==
            frame_status::ok);
    for (std::size_t i = 0; i < 4; ++i) {
        reflect_image(size, all_reflections[i], frame.data(), turned.data());
        REQUIRE(network.infer(tensor_view<const Count, size>(turned.data()), outputs_per_reflection[i]) ==
                frame_status::ok);
        // What comes the other way round is the same touch, to the bit.
        REQUIRE(both_ways.infer(tensor_view<const Count, size>(turned.data()), again, *memory) ==
                frame_status::ok);
        CHECK(again == found);
    }
    CHECK(outputs_per_reflection[0] != outputs_per_reflection[1]);
    for (std::size_t o = 0; o < net::outputs; ++o)
        CHECK(found[o] == (outputs_per_reflection[0][o] + outputs_per_reflection[1][o] +
                           (outputs_per_reflection[2][o] + outputs_per_reflection[3][o])) /
                              4);
}

} // namespace

TEST_CASE("reflection_average: the mean of four calls, the same bits whichever way round the frame comes") {
    check_average<std::uint8_t>();
    check_average<float>();
}

TEST_CASE("reflection_average: a broken frame is reported, and no heap is used") {
    const deployed<net> network = some_network();
    const average both_ways(network.view());
    const auto memory = std::make_unique<average::workspace>();
    std::array<float, size.size()> frame{};
    logits found;
    const tensor_view<const float, size> view(frame.data());
    const std::size_t before = support::allocations();
    CHECK(both_ways.infer(view, found, *memory) == frame_status::ok);
    CHECK(support::allocations() == before);
    frame[17] = std::numeric_limits<float>::quiet_NaN();
    CHECK(both_ways.infer(view, found, *memory) == frame_status::not_finite);
}
