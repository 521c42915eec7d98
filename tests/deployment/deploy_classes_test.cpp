#include "deployed_network.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/deployment/reflection_average.hpp>
#include <tactnet/runtime/thread_pool.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <support/allocations.hpp>
#include <utility>

using namespace tactnet;

namespace {

constexpr shape size{9, 11};
using net = network<size, conv2d<4, 3>, batch_norm, relu, max_pool<2>, dense<5>>;
using ending = network<size, conv2d<4, 3>, batch_norm, relu, max_pool<2>, dense<5>, softmax>;
using fast_model = deployed<net>;
using byte_frame = tensor_view<const std::uint8_t, size>;
using float_frame = tensor_view<const float, size>;

static_assert(noexcept(std::declval<const fast_model&>().classify(std::declval<byte_frame>())));
static_assert(noexcept(std::declval<const fast_model&>().classify(std::declval<float_frame>(),
                                                                  std::declval<fast_model::workspace&>())));

/// The name would be gone: a model that ends with the expression recognises nothing.
template <class Model>
concept recognises_bytes = requires(Model m, byte_frame counts) { std::forward<Model>(m).classify(counts); };
static_assert(recognises_bytes<const fast_model&> && !recognises_bytes<fast_model>);
// So would the weights.
template <class Model>
concept has_view = requires(Model m) { std::forward<Model>(m).view(); };
static_assert(has_view<const fast_model&> && !has_view<fast_model>);
static_assert(std::is_convertible_v<const fast_model&, fast_model::view_type> &&
              !std::is_convertible_v<fast_model, fast_model::view_type>);

template <class Network>
model<Network> trained(std::size_t classes) {
    model<Network> m;
    support::fill(m.network, 8);
    for (std::size_t e = 0; e < size.size(); ++e)
        m.normalise.mean.data()[e] = static_cast<float>(e % 7);
    m.normalise.scale = 0.02f;
    for (std::size_t c = 0; c < classes; ++c)
        m.classes.push_back(
            std::string("an object with a name beyond any short string, ").append(std::to_string(c)));
    return m;
}

std::array<std::uint8_t, size.size()> frame(std::uint64_t seed) {
    const auto counts = support::make_frame(size.size(), seed);
    std::array<std::uint8_t, size.size()> result{};
    std::copy(counts.begin(), counts.end(), result.begin());
    return result;
}

} // namespace

TEST_CASE("deployed: a temperature divides the logits, also those before a softmax at the end") {
    auto ends = deploy(trained<ending>(4));
    auto plain = deploy(trained<net>(4));
    ends.set_temperature(3), plain.set_temperature(3);
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        const auto counts = frame(seed);
        std::array<float, net::outputs> logits{};
        REQUIRE(plain.infer(counts, logits) == frame_status::ok);
        const double right = classify_logits(logits, 4, 3)->probability;
        CHECK(plain.classify(counts)->probability == right);
        CHECK(ends.classify(counts)->probability == doctest::Approx(right).epsilon(1e-5));
    }
    const std::array<float, 2> shares{0.25f, 0.5f};
    CHECK(classify_probabilities(shares, 2, 0.5)->probability == doctest::Approx(0.8)); // 4 of 1 + 4
    CHECK_FALSE(classify_probabilities(shares, 2, 0.0).has_value());
}

TEST_CASE("deployed: the class of the logits that it gives, and those of the bare network") {
    const auto m = trained<net>(5);
    const auto network = deploy(m);
    const auto bare = deploy(m.network, m.normalise.mean.view().elements(), m.normalise.scale);
    const auto memory = std::make_unique<fast_model::workspace>();
    std::array<std::size_t, 5> seen{};
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        const auto counts = frame(seed);
        std::array<float, net::outputs> logits{}, expected{};
        REQUIRE(network.infer(counts, logits) == frame_status::ok);
        REQUIRE(bare.infer(counts, expected) == frame_status::ok);
        CHECK(std::memcmp(logits.data(), expected.data(), sizeof(logits)) == 0);

        const auto right = classify_logits(logits, m.classes);
        std::array<float, size.size()> numbers;
        std::copy(counts.begin(), counts.end(), numbers.begin());
        for (const auto& found : {network.classify(counts), network.classify(counts, *memory),
                                  network.classify(numbers), network.classify(numbers, *memory)}) {
            REQUIRE(found);
            CHECK(found->index == right->index);
            CHECK(found->probability == right->probability);
            CHECK(found->name == m.classes[right->index]);
            CHECK(found->name.data() == network.classes()[right->index].data());
        }
        ++seen[right->index];
    }
    CHECK(std::count(seen.begin(), seen.end(), 40u) == 0); // not one class whatever the frame
}

TEST_CASE("deployed: a broken frame is no class") {
    const auto network = deploy(trained<net>(5));
    std::array<float, size.size()> numbers{};
    CHECK(network.classify(numbers));
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1e38f}) {
        numbers[50] = bad;
        std::array<float, net::outputs> logits{};
        CHECK(network.infer(numbers, logits) == frame_status::not_finite);
        CHECK_FALSE(network.classify(numbers));
    }
}

TEST_CASE("deployed: outputs beyond the classes are never named") {
    auto m = trained<net>(2);
    m.network.for_each_parameter([](const parameter& p, std::span<float> values) {
        if (p.name == "fc.bias")
            values[2] = values[3] = values[4] = 1000;
    });
    const auto network = deploy(m);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const auto counts = frame(seed);
        std::array<float, net::outputs> logits{};
        REQUIRE(network.infer(counts, logits) == frame_status::ok);
        const auto found = network.classify(counts);
        REQUIRE(found);
        CHECK(found->index == (logits[1] > logits[0]));
        CHECK(found->probability ==
              1 / (1 + std::exp(-std::abs(static_cast<double>(logits[1]) - static_cast<double>(logits[0])))));
    }
}

TEST_CASE("deployed: every call names only classes that exist") {
    auto m = trained<net>(4); // of 5 outputs
    m.network.for_each_parameter([](const parameter& p, std::span<float> values) {
        if (p.name == "fc.bias")
            values[4] = 1000;
    });
    const auto network = deploy(m);
    const fast_model::view_type view = network;
    CHECK(network.class_count() == 4);
    CHECK(view.class_count() == 4);
    const reflection_average average(view);
    const auto memory = std::make_unique<decltype(average)::workspace>();
    thread_pool pool(2);
    std::vector<std::array<std::uint8_t, size.size()>> frames;
    for (std::uint64_t seed = 0; seed < 9; ++seed)
        frames.push_back(frame(seed));
    const auto all = network.classify(frames, pool);
    batch_workspace kept;
    const auto again = network.classify(frames, pool, kept);
    REQUIRE(all.size() == frames.size());
    for (std::size_t i = 0; i < frames.size(); ++i) {
        std::array<float, net::outputs> logits{};
        REQUIRE(network.infer(frames[i], logits) == frame_status::ok);
        const auto right = classify_logits(logits, 4);
        CHECK(first_largest(logits) == 4); // which is no class
        CHECK(right->probability < 1);
        CHECK(view.classify(frames[i])->index == right->index);
        CHECK(view.classify(frames[i])->name.empty());
        CHECK(view.classify_outputs(logits)->index == right->index);
        CHECK(average.classify(frames[i], *memory)->index < 4);
        for (const auto& found : {network.classify(frames[i]), all[i], again[i]}) {
            REQUIRE(found);
            CHECK(found->index == right->index);
            CHECK(found->probability == right->probability);
            CHECK(found->name == m.classes[right->index]);
        }
    }
    // Without names, every output stands for a class.
    const auto bare = deploy(m.network, m.normalise.mean.view().elements(), m.normalise.scale);
    CHECK(bare.class_count() == 5);
    CHECK(bare.classify(frames[0])->index == 4);
    CHECK(bare.classify(frames[0])->name.empty());
}

TEST_CASE("deployed: of many frames, a broken one is no class, whatever becomes of its outputs") {
    const auto network = deploy(trained<net>(5));
    thread_pool pool(2);
    std::vector<float> frames(11 * size.size(), 3.0f);
    frames[4 * size.size() + 7] = std::numeric_limits<float>::quiet_NaN();
    frames[10 * size.size()] = std::numeric_limits<float>::infinity();
    const auto found = network.classify(frames, pool);
    REQUIRE(found.size() == 11);
    for (std::size_t i = 0; i < found.size(); ++i)
        CHECK(found[i].has_value() == (i != 4 && i != 10));
    frames.pop_back();
    CHECK_THROWS_WITH_AS(
        (void)network.classify(frames, pool),
        "deployed: expected frames of 99 counts and 5 outputs for each, found 1088 counts and "
        "50 outputs",
        std::invalid_argument);
    CHECK(network.classify(std::vector<float>(), pool).empty());
}

TEST_CASE("deployed: of equal logits the first class") {
    auto m = trained<net>(5);
    m.network.for_each_parameter([](const parameter& p, std::span<float> values) {
        if (p.name == "fc.weight")
            std::fill(values.begin(), values.end(), 0.0f);
        if (p.name == "fc.bias")
            std::fill(values.begin(), values.end(), 2.0f), values[0] = -1;
    });
    const auto network = deploy(m);
    const auto found = network.classify(frame(1));
    REQUIRE(found);
    CHECK(found->index == 1);
    CHECK(found->probability == 1 / (4 + std::exp(-3.0)));
}

TEST_CASE("deployed: a softmax at the end is not applied twice") {
    const auto logits = trained<net>(3);
    const auto probabilities = trained<ending>(3);
    const auto network = deploy(logits);
    const auto as_probabilities = deploy(probabilities);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const auto counts = frame(seed);
        const auto expected = network.classify(counts), found = as_probabilities.classify(counts);
        REQUIRE(expected);
        REQUIRE(found);
        CHECK(found->index == expected->index);
        // Each of the three probabilities was rounded once to single precision.
        CHECK(std::abs(found->probability - expected->probability) <= 0x1p-22 * expected->probability);
    }
}

TEST_CASE("deployed: names without an output and outputs without a name") {
    CHECK_THROWS_WITH_AS(static_cast<void>(deploy(trained<net>(6))),
                         "deploy: expected a model that names 1 to 5 classes, found 6 names",
                         std::invalid_argument);
    CHECK_THROWS_WITH_AS(static_cast<void>(deploy(trained<net>(0))),
                         "deploy: expected a model that names 1 to 5 classes, found 0 names",
                         std::invalid_argument);
}

TEST_CASE("deployed: a network with class names passes for a deployed network") {
    const auto m = trained<net>(5);
    const auto network = deploy(m);
    const fast_model::view_type view = network;
    std::array<float, net::outputs> out{}, expected{};
    REQUIRE(view.infer(frame(3), out) == frame_status::ok);
    REQUIRE(network.infer(frame(3), expected) == frame_status::ok);
    CHECK(out == expected);
    const header_description says{.network = "net", .namespace_name = "own", .classes = m.classes};
    CHECK(deployed_header(network, says, frame(3)).find("namespace own") != std::string::npos);
}

TEST_CASE("deployed: no heap, and names that outlive a move") {
    auto first = deploy(trained<net>(5));
    const auto counts = frame(2);
    const std::size_t before = support::allocations();
    const auto found = first.classify(counts);
    const std::size_t after = support::allocations();
    CHECK(after == before);
    REQUIRE(found);
    const fast_model second = std::move(first);
    CHECK(found->name == second.classes()[found->index]);
    CHECK(second.classify(counts)->probability == found->probability);
}
