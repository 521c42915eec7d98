#include <tactnet/runtime/random.hpp>

// Every header that declares a purpose.
#include <tactnet/features/k_means.hpp>
#include <tactnet/image/augmentation.hpp>
#include <tactnet/operators/activations/training.hpp>
#include <tactnet/simulation/effect.hpp>
#include <tactnet/simulation/objects/object.hpp>
#include <tactnet/training/initialise.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <set>
#include <vector>

using namespace tactnet;

// Known answers of Random123 1.14 (its kat_vectors): counter, key, result.
static_assert(philox({0, 0, 0, 0}, {0, 0}) ==
              std::array<std::uint32_t, 4>{0x6627e8d5, 0xe169c58d, 0xbc57ac4c, 0x9b00dbd8});
static_assert(philox({0xffffffff, 0xffffffff, 0xffffffff, 0xffffffff}, {0xffffffff, 0xffffffff}) ==
              std::array<std::uint32_t, 4>{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
static_assert(philox({0x243f6a88, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
              std::array<std::uint32_t, 4>{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1}); // digits of π

constexpr random_purpose other{4};

TEST_CASE("random_purpose: the library's have the numbers that they always had, each its own") {
    // Another number is another training and another data set from the same seed.
    const std::array purposes{random_purposes::split,        random_purposes::order,
                              random_purposes::augmentation, random_purposes::initial_weights,
                              random_purposes::dropout,      random_purposes::clusters,
                              random_purposes::noise,        random_purposes::sensor,
                              random_purposes::frame,        random_purposes::touch};
    for (std::uint32_t number = 0; number < purposes.size(); ++number)
        CHECK(purposes.at(number).number() == number);
}

TEST_CASE("random_purpose: names have numbers that the library never takes") {
    constexpr auto mine = random_purpose::named("my_gripper/slip"), yours = random_purpose::named("b");
    static_assert(mine == random_purpose::named("my_gripper/slip"));
    static_assert(mine != yours);
    CHECK(mine.number() >= 0x80000000);
    CHECK(random_purpose::named("").number() == (0x811C9DC5 | 0x80000000));
    // The published answers of FNV-1a; the highest bit is always set here.
    CHECK(random_purpose::named("b").number() == (0xE70C2DE5 | 0x80000000));
    CHECK(random_purpose::named("foobar").number() == (0xBF9CF968 | 0x80000000));
    CHECK(random_stream(1, mine).bits() != random_stream(1, yours).bits());
}

TEST_CASE("random_stream: the words of its counters, in order") {
    random_stream random(0x0123456789abcdef, other, 5, 6);
    for (std::uint32_t block = 0; block < 3; ++block) {
        const auto expected = philox({block, 4, 5, 6}, {0x89abcdef, 0x01234567});
        for (const std::uint32_t word : expected)
            CHECK(random.bits() == word);
    }
}

TEST_CASE("random_stream: another seed, purpose or item has other numbers") {
    std::set<std::uint32_t> first;
    for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{1} << 32})
        for (const random_purpose purpose : {random_purposes::split, random_purposes::order, other})
            for (const std::uint32_t major : {0u, 1u})
                for (const std::uint32_t minor : {0u, 1u})
                    first.insert(random_stream(seed, purpose, major, minor).bits());
    CHECK(first.size() == 36);
}

// Statistics: n draws, five standard deviations.

TEST_CASE("random_stream: uniform") {
    random_stream random(1, random_purposes::order);
    constexpr int n = 100000;
    double sum = 0, squares = 0, smallest = 1, largest = 0;
    for (int i = 0; i < n; ++i) {
        const double x = random.uniform();
        sum += x, squares += x * x;
        smallest = std::min(smallest, x), largest = std::max(largest, x);
    }
    CHECK(smallest >= 0);
    CHECK(largest < 1);
    CHECK(std::abs(sum / n - 0.5) < 5 * std::sqrt(1.0 / 12 / n));
    CHECK(std::abs(squares / n - 1.0 / 3) < 5 * std::sqrt(4.0 / 45 / n));
    for (int i = 0; i < 1000; ++i) {
        const double x = random.uniform(-3, 5);
        CHECK((x >= -3 && x < 5));
    }
}

TEST_CASE("random_stream: normal") {
    random_stream random(2, random_purposes::order);
    constexpr int n = 100000;
    double moments[5] = {};
    int beyond = 0;
    for (int i = 0; i < n; ++i) {
        const double x = random.normal();
        REQUIRE(std::isfinite(x));
        for (int k = 1; k <= 4; ++k)
            moments[k] += std::pow(x, k) / n;
        beyond += std::abs(x) > 1.959964;
    }
    CHECK(std::abs(moments[1]) < 5 * std::sqrt(1.0 / n));
    CHECK(std::abs(moments[2] - 1) < 5 * std::sqrt(2.0 / n));
    CHECK(std::abs(moments[3]) < 5 * std::sqrt(15.0 / n));
    CHECK(std::abs(moments[4] - 3) < 5 * std::sqrt(96.0 / n));
    CHECK(std::abs(beyond - 0.05 * n) < 5 * std::sqrt(n * 0.05 * 0.95));
}

TEST_CASE("random_stream: below") {
    random_stream random(3, random_purposes::order);
    constexpr int n = 70000;
    std::array<int, 7> counts{};
    for (int i = 0; i < n; ++i)
        ++counts.at(random.below(7));
    for (const int count : counts)
        CHECK(std::abs(count - n / 7) < 5 * std::sqrt(n * (1.0 / 7) * (6.0 / 7)));
    for (int i = 0; i < 100; ++i)
        CHECK(random.below(1) == 0);
}

TEST_CASE("random_stream: shuffle keeps the elements and gives every order alike") {
    random_stream random(4, random_purposes::order);
    std::vector<int> many(100);
    std::iota(many.begin(), many.end(), 0);
    const std::vector<int> ordered = many;
    random.shuffle(many);
    CHECK(many != ordered);
    CHECK(std::is_permutation(many.begin(), many.end(), ordered.begin()));

    constexpr int n = 24000;
    std::array<int, 64> orders{};
    for (int i = 0; i < n; ++i) {
        std::array<int, 3> three{0, 1, 2};
        random.shuffle(three);
        ++orders[static_cast<std::size_t>(three[0] * 16 + three[1] * 4 + three[2])];
    }
    CHECK(std::count_if(orders.begin(), orders.end(), [](int c) { return c > 0; }) == 6);
    for (const int count : orders)
        if (count > 0)
            CHECK(std::abs(count - n / 6) < 5 * std::sqrt(n * (1.0 / 6) * (5.0 / 6)));
    std::vector<int> none, one{7};
    random.shuffle(none);
    random.shuffle(one);
    CHECK(one[0] == 7);
}

TEST_CASE("philox: the published answers when a program runs, as when it is compiled") {
    volatile std::uint32_t most = 0xffffffff; // so that nothing is known while compiling
    CHECK(philox({most, most, most, most}, {most, most}) ==
          std::array<std::uint32_t, 4>{0x408f276d, 0x41c83b0e, 0xa20bc7c6, 0x6d5451fd});
    volatile std::uint32_t first = 0x243f6a88;
    CHECK(philox({first, 0x85a308d3, 0x13198a2e, 0x03707344}, {0xa4093822, 0x299f31d0}) ==
          std::array<std::uint32_t, 4>{0xd16cfe09, 0x94fdcceb, 0x5001e420, 0x24126ea1});
}
TEST_CASE("random_stream: begins with the first counter of its item, and items are 0 if nothing is said") {
    const std::uint64_t seed = 0x0123456789abcdef;
    const auto first = [&](std::uint32_t major, std::uint32_t minor) {
        return philox({0, other.number(), major, minor}, {0x89abcdef, 0x01234567})[0];
    };
    CHECK(random_stream(seed, other).bits() == first(0, 0));
    CHECK(random_stream(seed, other, 5).bits() == first(5, 0));
    CHECK(random_stream(seed, other, 5, 7).bits() == first(5, 7));
}
