#include <tactnet/networks/recognition.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <string_view>
#include <support/allocations.hpp>
#include <utility>
#include <vector>

using namespace tactnet;

namespace {

constexpr float not_a_number = std::numeric_limits<float>::quiet_NaN();
constexpr float infinite = std::numeric_limits<float>::infinity();

static_assert(noexcept(classify_logits(std::declval<std::span<const float>>(), 3)));
static_assert(noexcept(classify_logits(std::declval<std::span<const float>>(),
                                       std::declval<const std::vector<std::string>&>())));
static_assert(noexcept(classify_probabilities(std::declval<std::span<const float>>(),
                                              std::declval<const std::array<std::string_view, 3>&>())));

static_assert(first_largest(std::array{1.0f, 3.0f, 2.0f}) == 1);
static_assert(first_largest(std::array{-1.0f, 3.0f, 3.0f}) == 1);
static_assert(first_largest(std::array{not_a_number, 3.0f, not_a_number, 4.0f}) == 3);
static_assert(first_largest(std::array{not_a_number, not_a_number}) == 0);
static_assert(first_largest({}) == 0);

} // namespace

// Names of a temporary would be gone with it.
template <class Names>
concept may_name = requires(std::span<const float> logits, Names names) {
    tactnet::classify_logits(logits, std::forward<Names>(names));
    tactnet::classify_probabilities(logits, std::forward<Names>(names));
};
static_assert(may_name<const std::vector<std::string>&> && may_name<std::span<const std::string>>);
static_assert(!may_name<std::vector<std::string>>);

// How many of the outputs stand for a class has to be said.
template <class Outputs>
concept guesses_classes = requires(const Outputs& outputs) { tactnet::classify_logits(outputs); };
static_assert(!guesses_classes<std::array<float, 22>> && !guesses_classes<std::span<const float>>);

TEST_CASE("recognition: the largest logit and its softmax") {
    const auto found = classify_logits(std::array{1.0f, -2.0f, 2.5f, 0.0f}, 4);
    REQUIRE(found);
    CHECK(found->index == 2);
    CHECK(found->probability == 1 / (std::exp(-1.5) + std::exp(-4.5) + 1 + std::exp(-2.5)));
    CHECK(found->name.empty());

    // Far apart and far from zero: no overflow on the way.
    const auto sure = classify_logits(std::array{-3e38f, 3e38f, 0.0f}, 3);
    REQUIRE(sure);
    CHECK(sure->index == 1);
    CHECK(sure->probability == 1);
    const auto single = classify_logits(std::array{-1e30f}, 1);
    REQUIRE(single);
    CHECK(single->probability == 1);
}

TEST_CASE("recognition: of equal logits the first") {
    const auto found = classify_logits(std::array{0.0f, 7.0f, 7.0f, 7.0f, -1e4f}, 5);
    REQUIRE(found);
    CHECK(found->index == 1);
    CHECK(found->probability == doctest::Approx(1.0 / 3).epsilon(1e-3));
    const auto zeros = classify_logits(std::array{-0.0f, 0.0f}, 2);
    REQUIRE(zeros);
    CHECK(zeros->index == 0);
    CHECK(zeros->probability == 0.5);
}

TEST_CASE("recognition: a logit that is not finite gives no class, at any place") {
    for (std::size_t at = 0; at < 3; ++at)
        for (const float bad : {not_a_number, infinite, -infinite}) {
            std::array logits{3.0f, 1.0f, 2.0f};
            logits[at] = bad;
            CHECK_FALSE(classify_logits(logits, 3));
            CHECK_FALSE(classify_probabilities(logits, 3));
        }
    CHECK_FALSE(classify_logits({}, std::size_t{0}));
    CHECK_FALSE(classify_probabilities({}, std::size_t{0}));
}

TEST_CASE("recognition: names, and further outputs are unused") {
    const std::vector<std::string> names{"cable", "mug"};
    const auto found = classify_logits(std::array{1.0f, 2.0f, 9.0f}, names);
    REQUIRE(found);
    CHECK(found->index == 1);
    CHECK(found->name == "mug");
    CHECK(found->name.data() == names[1].data());
    CHECK(found->probability == 1 / (std::exp(-1.0) + 1));
    CHECK(classify_logits(std::array{1.0f, 2.0f, not_a_number}, names)); // no class

    constexpr std::array<std::string_view, 2> constants{"cable", "mug"};
    CHECK(classify_logits(std::array{2.0f, 1.0f}, constants)->name == "cable");
    CHECK_FALSE(classify_logits(std::array{1.0f}, names));
    const std::vector<std::string> none;
    CHECK_FALSE(classify_logits(std::array{1.0f}, none));
}

TEST_CASE("recognition: an output beyond the classes is never named") {
    std::array<float, 22> outputs{};
    outputs[21] = 1000;
    outputs[7] = 1;
    CHECK(classify_logits(outputs, 22)->index == 21);
    CHECK(classify_logits(outputs, 21)->index == 7);
    CHECK(classify_logits(outputs, 21)->probability < 0.13); // e of e + 20
    CHECK(classify_probabilities(outputs, 21)->index == 7);
    CHECK(classify_probabilities(outputs, 21)->probability == 1);
    CHECK_FALSE(classify_logits(outputs, 23)); // more classes than outputs
    CHECK_FALSE(classify_probabilities(outputs, 23));
    CHECK_FALSE(classify_logits(outputs, std::size_t{0}));
}

TEST_CASE("recognition: of probabilities, as shares of the named classes") {
    const std::vector<std::string> names{"cable", "mug", "ball"};
    const auto found = classify_probabilities(std::array{0.125f, 0.25f, 0.25f, 0.375f}, names);
    REQUIRE(found);
    CHECK(found->index == 1);
    CHECK(found->name == "mug");
    CHECK(found->probability == 0.4);
    CHECK_FALSE(classify_probabilities(std::array{0.0f, 0.0f, 0.0f, 1.0f}, names));
}

TEST_CASE("recognition: no heap") {
    const std::vector<std::string> names{"cable", "mug"};
    const std::array logits{1.0f, 2.0f};
    const std::size_t before = support::allocations();
    const auto found = classify_logits(logits, names);
    const std::size_t after = support::allocations();
    CHECK(found->name == "mug");
    CHECK(after == before);
}

namespace {

constexpr shape image{2, 3, 2};
using pixels = std::array<int, image.size()>;

pixels reflected(const pixels& from, reflection how) {
    pixels to{};
    reflect_image(image, how, from.data(), to.data());
    return to;
}

} // namespace

TEST_CASE("reflection: rows, columns or both are exchanged, channel by channel") {
    pixels from{};
    std::iota(from.begin(), from.end(), 0);
    CHECK(reflected(from, {}) == from);
    CHECK(reflected(from, {.rows = true}) == pixels{3, 4, 5, 0, 1, 2, 9, 10, 11, 6, 7, 8});
    CHECK(reflected(from, {.columns = true}) == pixels{2, 1, 0, 5, 4, 3, 8, 7, 6, 11, 10, 9});
    CHECK(reflected(from, {.rows = true, .columns = true}) == pixels{5, 4, 3, 2, 1, 0, 11, 10, 9, 8, 7, 6});
    for (const reflection how : all_reflections)
        CHECK(reflected(reflected(from, how), how) == from);
}

TEST_CASE("reflection: each of the four gives the same bits of the mean") {
    // Numbers whose sum depends on its order.
    const float a = 1e8f, b = 1.1f, c = -1e8f, d = 3.3f;
    const float mean = mean_of_reflections(a, b, c, d);
    CHECK(mean_of_reflections(b, a, d, c) == mean); // of the image with its rows exchanged
    CHECK(mean_of_reflections(c, d, a, b) == mean);
    CHECK(mean_of_reflections(d, c, b, a) == mean);
    CHECK(mean_of_reflections(1, 2, 3, 6) == 3);
}
