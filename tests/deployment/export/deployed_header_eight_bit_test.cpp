#include "branched.hpp"
#include "rooted.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <deployment/export/eight_bit_networks.hpp>
#include <memory>
#include <numeric>
#include <span>
#include <type_traits>

// A header in 8 bits is the network that it was written from, though it ends in probabilities and takes
// roots.

namespace {

/// How many of some frames give other bits than before the network was written.
template <class Network, class Recogniser, class Packed>
std::size_t frames_that_differ(const Recogniser& recogniser, const Packed& packed) {
    const auto original = deployed_in_8_bits<Network>();
    using view = typename tactnet::deployed<Network, tactnet::eight_bit>::view_type;
    static_assert(std::is_same_v<Recogniser, view>);
    const auto again = std::make_unique<typename Recogniser::packed_weights>();
    Recogniser::pack(original.folded().data(), again->elements.data());
    CHECK(std::ranges::equal(again->elements, packed.elements));
    std::size_t different = 0;
    for (std::size_t i = 0; i < 40; ++i) {
        const auto frame = frame_of<Network>(i);
        const tactnet::tensor_view<const std::uint8_t, Network::input_shape> counts(frame);
        std::array<float, Recogniser::outputs> expected, found;
        REQUIRE(original.infer(counts, expected) == tactnet::frame_status::ok);
        REQUIRE(recogniser.infer(counts, found) == tactnet::frame_status::ok);
        different += !std::ranges::equal(expected, found, [](float a, float b) {
            return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
        });
        CHECK(std::accumulate(found.begin(), found.end(), 0.0f) == doctest::Approx(1).epsilon(1e-5));
    }
    return different;
}

} // namespace

TEST_CASE("deployed_header: in 8 bits, roots and probabilities give the bits that they gave before") {
    CHECK(frames_that_differ<rooted_network>(rooted::recogniser, rooted::packed) == 0);
    CHECK(frames_that_differ<branched_network>(branched::recogniser, branched::packed) == 0);
    CHECK(rooted::passes_selftest());
    CHECK(branched::passes_selftest());
    CHECK(rooted::classes[3] == "d");
    CHECK(branched::classes.empty());
    CHECK(std::ranges::equal(rooted::folded, deployed_in_8_bits<rooted_network>().folded()));
}
