#include "recorded.hpp"
#include "recorded_in_bytes.hpp"
#include "tagging.hpp"

#include <tactnet/deployment/export/deployed_header.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <deployment/export/streams.hpp>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <support/same_bits.hpp>
#include <type_traits>
#include <vector>

// What the header of a stream says is the stream that it was written from: the same type, the same weights,
// the same bits.

namespace {

template <class Network, class Format, class Recogniser>
void same_as(const Recogniser& recogniser, std::span<const float> folded) {
    const auto original = deployed_stream_of<Network>(Format{});
    using view = typename std::remove_const_t<decltype(original)>::view_type;
    static_assert(std::is_same_v<std::remove_const_t<Recogniser>, view>);
    CHECK(support::same_bits(folded, original.folded()));
    const std::vector<float> recording = recordings<Network>(20, 3);
    std::vector<float> expected(recording.size() / view::features * view::outputs, 1), found(expected.size());
    typename view::state of_original, of_header;
    const std::size_t frames = recording.size() / view::features;
    REQUIRE(original.run(recording, of_original, expected) == frames);
    REQUIRE(recogniser.run(recording, of_header, found) == frames);
    CHECK(support::same_bits(expected, found));
    if (recogniser.class_count() == view::outputs) {
        const auto frame = std::span(recording).template first<view::features>();
        CHECK(recogniser.classify(frame, of_header)->probability ==
              original.classify(frame, of_original)->probability);
    }
    CHECK(std::any_of(found.begin(), found.end(), [&](float value) { return value != found[0]; }));
}

} // namespace

TEST_CASE("deployed_header: the stream that it was written from") {
    same_as<recorded_network, tactnet::single_precision>(recorded::recogniser, recorded::folded);
    same_as<recorded_network, tactnet::eight_bit>(recorded_in_bytes::recogniser, recorded_in_bytes::folded);
    same_as<tagging_network, tactnet::eight_bit>(tagging::recogniser, tagging::folded);
    CHECK(recorded::passes_selftest());
    CHECK(recorded_in_bytes::passes_selftest());
    CHECK(tagging::passes_selftest());
    CHECK(recorded::classes.size() == 2);
    CHECK(recorded::classes[1] == "grip");
    CHECK(recorded_in_bytes::classes.empty());
    CHECK(recorded_in_bytes::recogniser.class_count() == 2); // without names
    CHECK(tagging::classes.size() == 1);
    CHECK(tagging::recogniser.class_count() == 1);
    tagging::recogniser_type::state state;
    const auto found = tagging::recogniser.classify(std::array<float, 5>{1, -1, 1, 0, 0}, state);
    CHECK(found->index == 0); // the only class
    CHECK(found->probability == 1);
}

TEST_CASE(
    "deployed_header: 8-bit streams are packed when compiling only if Clang's default limit allows it") {
    const tactnet::header_description says{.network = "x", .namespace_name = "a", .classes = {}};
    const auto packed_when_compiling = [&](const auto& stream, std::span<const float> recording) {
        const std::string text = tactnet::deployed_header(stream, says, recording);
        return text.find("inline constexpr recogniser_type::packed_weights") != std::string::npos;
    };
    const auto recording = recordings<recorded_network>(1, 1);
    CHECK(
        packed_when_compiling(deployed_stream_of<recorded_network>(tactnet::single_precision{}), recording));
    CHECK_FALSE(packed_when_compiling(deployed_stream_of<recorded_network>(tactnet::eight_bit{}), recording));
    CHECK(packed_when_compiling(deployed_stream_of<tagging_network>(tactnet::eight_bit{}),
                                recordings<tagging_network>(1, 1)));
}

TEST_CASE("deployed_header: rejects recordings that a stream cannot take") {
    const auto stream = deployed_stream_of<recorded_network>(tactnet::single_precision{});
    const tactnet::header_description says{.network = "x", .namespace_name = "a", .classes = {}};
    std::vector<float> recording = recordings<recorded_network>(1, 1);
    for (const std::size_t size : {std::size_t{0}, std::size_t{4}})
        CHECK_THROWS_WITH_AS((void)tactnet::deployed_header(stream, says, std::span(recording).first(size)),
                             doctest::Contains("expected a recording of one or more frames of 3 features"),
                             std::invalid_argument);
    recording[7] = std::numeric_limits<float>::quiet_NaN();
    CHECK_THROWS_WITH_AS((void)tactnet::deployed_header(stream, says, recording),
                         doctest::Contains("found a frame that it refuses"), std::invalid_argument);
    recording[7] = 0;
    CHECK_THROWS_WITH_AS((void)tactnet::deployed_header(stream, {"x", "a", {"1", "2", "3"}}, recording),
                         doctest::Contains("expected at most 2 class names, found 3"), std::invalid_argument);
}
