#include "large.hpp"
#include "mixed.hpp"
#include "small.hpp"

#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/deployment/export/header_form.hpp>
#include <tactnet/transfer/as_photograph.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <deployment/export/networks.hpp>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>

// What a header says is the network that it was written from: the same type, the same weights, the same bits.

namespace {

template <class Network, class Recogniser, class Packed>
void same_as(const Recogniser& recogniser, const Packed& packed) {
    const auto original = deployed_network<Network>();
    static_assert(std::is_same_v<Recogniser, const typename tactnet::deployed<Network>::view_type> ||
                  std::is_same_v<Recogniser, typename tactnet::deployed<Network>::view_type>);
    std::array<float, Recogniser::packed_elements> again{};
    Recogniser::pack(original.folded().data(), again.data());
    CHECK(std::equal(again.begin(), again.end(), packed.elements.begin(), [](float a, float b) {
        return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b);
    }));
    for (std::size_t i = 0; i < 20; ++i) {
        const auto frame = frame_of<Network>(i);
        const tactnet::tensor_view<const std::uint8_t, Network::input_shape> counts(frame);
        std::array<float, Recogniser::outputs> expected, found;
        REQUIRE(original.infer(counts, expected) == tactnet::frame_status::ok);
        REQUIRE(recogniser.infer(counts, found) == tactnet::frame_status::ok);
        CHECK(std::equal(expected.begin(), expected.end(), found.begin()));
        const auto right = Network::ends_in_softmax
                               ? tactnet::classify_probabilities(expected, recogniser.class_count(), 0.7)
                               : tactnet::classify_logits(expected, recogniser.class_count(), 0.7);
        CHECK(recogniser.classify(counts)->index == right->index);
        CHECK(recogniser.classify(counts)->probability == right->probability);
    }
}

} // namespace

TEST_CASE("deployed_header: the network that it was written from") {
    namespace small = gripper::recognition;
    static_assert(small::packed.elements.size() > 0 &&
                  small::folded[small_network::input_shape.size()] == 1.0f / 64);
    same_as<small_network>(small::recogniser, small::packed);
    same_as<mixed_network>(mixed::recogniser, mixed::packed);
    CHECK(small::passes_selftest());
    CHECK(mixed::passes_selftest());
    CHECK(small::classes.size() == 3);
    CHECK(small::recogniser.class_count() == 3);
    CHECK(mixed::recogniser.class_count() == mixed::recogniser_type::outputs); // without names
    CHECK(small::classes[1] == "\"a\\b\"\n?\?/");
    CHECK(small::classes[2] == "é");
    CHECK(mixed::classes.empty());
    CHECK(small::recogniser.reflections().axes().rows);
    CHECK_FALSE(mixed::recogniser.reflections().axes().rows);
    CHECK(mixed::recogniser.reflections().columns.partner(0) == 2);
}

TEST_CASE("deployed_header: a network that no stack holds takes its memory from the caller") {
    const auto original = deployed_network<large_network>();
    using original_type = tactnet::deployed<large_network>;
    static_assert(std::is_same_v<decltype(large::recogniser), const original_type::view_type> ||
                  std::is_same_v<decltype(large::recogniser), original_type::view_type>);
    const auto memory = std::make_unique<original_type::workspace>();
    CHECK(large::passes_selftest(*memory));
    for (std::size_t i = 0; i < 5; ++i) {
        const auto frame = frame_of<large_network>(i);
        const tactnet::tensor_view<const std::uint8_t, large_network::input_shape> counts(frame);
        std::array<float, original_type::outputs> expected, found;
        REQUIRE(original.infer(counts, expected, *memory) == tactnet::frame_status::ok);
        REQUIRE(large::recogniser.infer(counts, found, *memory) == tactnet::frame_status::ok);
        CHECK(std::equal(expected.begin(), expected.end(), found.begin()));
    }
}

TEST_CASE("deployed_header: the folded numbers to the bit") {
    const auto original = deployed_network<mixed_network>();
    CHECK(std::equal(
        original.folded().begin(), original.folded().end(), mixed::folded.begin(),
        [](float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }));
    CHECK(tactnet::detail::literal<float>(-0.0f) == "-0x0p+0f");
    CHECK(tactnet::detail::literal<float>(-1.5f) == "-0x1.8p+0f");
    CHECK(tactnet::detail::literal<float>(0x1p-149f).starts_with("0x"));
}

TEST_CASE("deployed_header: names of namespaces") {
    for (const char* good : {"a", "gripper", "gripper::tactile", "g2_x::y", "classes", "null", "asserts::x",
                             "mains", "gripper::time", "timer", "ABB", "Left_2", "x_"})
        CHECK_MESSAGE(tactnet::is_namespace_name(good), good);
    for (const char* bad :
         {"",          "2a",   "a-b",        "a b",    "a::",    "::a",      "a:b",
          "a:::b",     "_a",   "a__b",       "class",  "a::int", "std",      "tactnet::x",
          "a::std",    "é",    "a\n",        "a;b",    "a:",     ":",        "static static_assert",
          "NULL",      "EOF",  "assert",     "posix",  "main",   "a::errno", "INT_MAX",
          "INT64_MAX", "M_PI", "a::DBL_MIN", "memcpy", "time",   "abs::x",   "y0"})
        CHECK_FALSE_MESSAGE(tactnet::is_namespace_name(bad), bad);
}

TEST_CASE("deployed_header: rejected arguments") {
    const auto original = deployed_network<small_network>();
    const auto frame = frame_of<small_network>(0);
    CHECK_THROWS_WITH_AS((void)tactnet::deployed_header(original, {"x", "a-b", {}}, frame),
                         doctest::Contains("found 'a-b'"), std::invalid_argument);
    CHECK_THROWS_WITH_AS(
        (void)tactnet::deployed_header(original, {"x", "a", {"1", "2", "3", "4", "5", "6"}}, frame),
        doctest::Contains("expected at most 5 class names, found 6"), std::invalid_argument);
    // The same text every time.
    CHECK(tactnet::deployed_header(original, {"x", "a", {}}, frame) ==
          tactnet::deployed_header(original, {"x", "a", {}}, frame));
}

TEST_CASE("string_literal: printable ASCII stays, what means something is escaped, all else is octal") {
    using tactnet::detail::string_literal;
    CHECK(string_literal("") == "\"\"");
    CHECK(string_literal(" a~") == "\" a~\"");
    CHECK(string_literal("a\"b\\c") == "\"a\\\"b\\\\c\"");
    CHECK(string_literal("?\?=") == "\"\\?\\?=\"");
    CHECK(string_literal(std::string("\x1f\x7f\0", 3)) == "\"\\037\\177\\000\"");
    CHECK(string_literal("\xc3\xa9") == "\"\\303\\251\""); // é in UTF-8
}

TEST_CASE("one_line: no character is left that ends a comment or continues it in the next line") {
    CHECK(tactnet::detail::one_line("a\nb\rc\td\\") == "a b c d ");
    CHECK(tactnet::detail::one_line(" ~\xc3\xa9") == " ~\xc3\xa9");
}
