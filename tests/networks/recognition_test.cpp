#include <tactnet/networks/recognition.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
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

static_assert(noexcept(likeliest(std::declval<std::span<const float>>())));
static_assert(noexcept(likeliest(std::declval<std::span<const float>>(),
                                 std::declval<const std::vector<std::string>&>())));
static_assert(noexcept(most_probable(std::declval<std::span<const float>>(),
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
    tactnet::likeliest(logits, std::forward<Names>(names));
    tactnet::most_probable(logits, std::forward<Names>(names));
};
static_assert(may_name<const std::vector<std::string>&> && may_name<std::span<const std::string>>);
static_assert(!may_name<std::vector<std::string>>);

TEST_CASE("recognition: the largest logit and its softmax") {
    const auto found = likeliest(std::array{1.0f, -2.0f, 2.5f, 0.0f});
    REQUIRE(found);
    CHECK(found->index == 2);
    CHECK(found->probability == 1 / (std::exp(-1.5) + std::exp(-4.5) + 1 + std::exp(-2.5)));
    CHECK(found->name.empty());

    // Far apart and far from zero: no overflow on the way.
    const auto sure = likeliest(std::array{-3e38f, 3e38f, 0.0f});
    REQUIRE(sure);
    CHECK(sure->index == 1);
    CHECK(sure->probability == 1);
    const auto single = likeliest(std::array{-1e30f});
    REQUIRE(single);
    CHECK(single->probability == 1);
}

TEST_CASE("recognition: of equal logits the first") {
    const auto found = likeliest(std::array{0.0f, 7.0f, 7.0f, 7.0f, -1e4f});
    REQUIRE(found);
    CHECK(found->index == 1);
    CHECK(found->probability == doctest::Approx(1.0 / 3).epsilon(1e-3));
    const auto zeros = likeliest(std::array{-0.0f, 0.0f});
    REQUIRE(zeros);
    CHECK(zeros->index == 0);
    CHECK(zeros->probability == 0.5);
}

TEST_CASE("recognition: a logit that is not finite recognises nothing, wherever it stands") {
    for (std::size_t at = 0; at < 3; ++at)
        for (const float bad : {not_a_number, infinite, -infinite}) {
            std::array logits{3.0f, 1.0f, 2.0f};
            logits[at] = bad;
            CHECK_FALSE(likeliest(logits));
            CHECK_FALSE(most_probable(logits));
        }
    CHECK_FALSE(likeliest({}));
    CHECK_FALSE(most_probable({}));
}

TEST_CASE("recognition: names, and outputs behind them that stand for nothing") {
    const std::vector<std::string> names{"cable", "mug"};
    const auto found = likeliest(std::array{1.0f, 2.0f, 9.0f}, names);
    REQUIRE(found);
    CHECK(found->index == 1);
    CHECK(found->name == "mug");
    CHECK(found->name.data() == names[1].data());
    CHECK(found->probability == 1 / (std::exp(-1.0) + 1));
    CHECK(likeliest(std::array{1.0f, 2.0f, not_a_number}, names)); // what stands for nothing may be anything

    constexpr std::array<std::string_view, 2> constants{"cable", "mug"};
    CHECK(likeliest(std::array{2.0f, 1.0f}, constants)->name == "cable");
    CHECK_FALSE(likeliest(std::array{1.0f}, names));
    const std::vector<std::string> none;
    CHECK_FALSE(likeliest(std::array{1.0f}, none));
}

TEST_CASE("recognition: of probabilities, as shares of the named classes") {
    const std::vector<std::string> names{"cable", "mug", "ball"};
    const auto found = most_probable(std::array{0.125f, 0.25f, 0.25f, 0.375f}, names);
    REQUIRE(found);
    CHECK(found->index == 1);
    CHECK(found->name == "mug");
    CHECK(found->probability == 0.4);
    CHECK_FALSE(most_probable(std::array{0.0f, 0.0f, 0.0f, 1.0f}, names));
}

TEST_CASE("recognition: no heap") {
    const std::vector<std::string> names{"cable", "mug"};
    const std::array logits{1.0f, 2.0f};
    const std::size_t before = support::allocations();
    const auto found = likeliest(logits, names);
    const std::size_t after = support::allocations();
    CHECK(found->name == "mug");
    CHECK(after == before);
}
