#include "deployed_network.hpp"

#include <tactnet/deployment.hpp>
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

using numbers = std::array<float, average::features>;
static_assert(average::features > 0);

/// The mean as it is documented: sums of two, and half of them, so that no order of reflections matters.
template <std::size_t Size>
bool is_mean(const std::array<float, Size>& found, const std::array<std::array<float, Size>, 4>& each) {
    for (std::size_t e = 0; e < Size; ++e)
        if (found[e] != (each[0][e] + each[1][e] + (each[2][e] + each[3][e])) / 4)
            return false;
    return true;
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

    const auto memory_of_one = std::make_unique<deployed<net>::workspace>();
    std::array<logits, 4> outputs_per_reflection;
    std::array<numbers, 4> features_per_reflection;
    logits found, again;
    numbers features;
    REQUIRE(both_ways.infer(tensor_view<const Count, size>(frame.data()), found, *memory) ==
            frame_status::ok);
    REQUIRE(both_ways.infer(tensor_view<const Count, size>(frame.data()), again, features, *memory) ==
            frame_status::ok);
    CHECK(again == found);
    for (std::size_t i = 0; i < 4; ++i) {
        reflect_image(size, all_reflections[i], frame.data(), turned.data());
        REQUIRE(network.infer(tensor_view<const Count, size>(turned.data()), outputs_per_reflection[i],
                              *memory_of_one) == frame_status::ok);
        network.read_features(*memory_of_one, features_per_reflection[i]);
        // A reflected touch is the same touch, to the bit.
        REQUIRE(both_ways.infer(tensor_view<const Count, size>(turned.data()), again, *memory) ==
                frame_status::ok);
        CHECK(again == found);
    }
    CHECK(outputs_per_reflection[0] != outputs_per_reflection[1]);
    CHECK(is_mean(found, outputs_per_reflection));
    CHECK(features_per_reflection[0] != features_per_reflection[1]);
    CHECK(is_mean(features, features_per_reflection));
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
    numbers features;
    const tensor_view<const float, size> view(frame.data());
    const std::size_t before = support::allocations();
    CHECK(both_ways.infer(view, found, *memory) == frame_status::ok);
    CHECK(both_ways.infer(view, found, features, *memory) == frame_status::ok);
    CHECK(support::allocations() == before);
    frame[17] = std::numeric_limits<float>::quiet_NaN();
    CHECK(both_ways.infer(view, found, *memory) == frame_status::not_finite);
    CHECK(both_ways.infer(view, found, features, *memory) == frame_status::not_finite);
}
