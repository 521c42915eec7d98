#include <tactnet/tensor/batch.hpp>
#include <tactnet/training/data/sample_batch.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

using namespace tactnet;

TEST_CASE("sample_batch: is empty by default") {
    CHECK(sample_batch(6).samples() == 0);
    CHECK(sample_batch(6).elements().empty());
}

TEST_CASE("sample_batch: lies in memory as a batch of the same size") {
    constexpr shape size{2, 3, 1};
    for (const std::size_t samples : {1u, 5u, 17u, 40u}) {
        sample_batch found(size.size(), samples);
        batch<float, size, kernels::lanes<float>> expected(samples);
        REQUIRE(found.samples() == samples);
        REQUIRE(found.size() == size.size());
        for (std::size_t i = 0; i < samples; ++i) {
            std::array<float, size.size()> values;
            for (std::size_t e = 0; e < values.size(); ++e)
                values[e] = static_cast<float>(100 * i + e + 1);
            found.set(i, values);
            for (std::size_t e = 0; e < values.size(); ++e) {
                expected(i, e) = values[e];
                CHECK(found(i, e) == values[e]);
            }
        }
        const auto view = expected.as_const();
        CHECK(std::equal(view.data(), view.data() + view.lane_blocks() * view.lane_block_size, found.data()));
        found.resize(samples); // zero again
        CHECK(std::all_of(found.data(), found.data() + view.lane_blocks() * view.lane_block_size,
                          [](float v) { return v == 0; }));
    }
}

TEST_CASE("input_batch: counts as they are, less the mean of the chosen images, and scaled") {
    const std::array<std::uint8_t, 6> pixels{10, 20, 7, 255, 13, 0};
    const std::array<std::size_t, 2> chosen{0, 2};
    thread_pool alone;
    input_batch batch(2, alone);
    const auto fill = [&] {
        batch.fill(3, [&](std::size_t i, std::span<float> counts) {
            for (std::size_t e = 0; e < counts.size(); ++e)
                counts[e] = static_cast<float>(pixels[2 * i + e]);
        });
    };
    fill();
    REQUIRE(batch.samples().samples() == 3);
    CHECK(batch.samples()(1, 1) == 255);
    batch.subtract_mean(pixels, chosen);
    CHECK(batch.mean()[0] == 11.5F);
    CHECK(batch.mean()[1] == 10);
    fill();
    CHECK(batch.samples()(0, 0) == -1.5F);
    CHECK(batch.samples()(1, 1) == 245);
    batch.scale_by(2);
    CHECK(batch.scale() == 2);
    fill();
    CHECK(batch.samples()(2, 0) == 3);
    CHECK(batch.samples()(2, 1) == -20);
}

TEST_CASE("input_batch: the same on any number of threads, each image once") {
    constexpr std::size_t size = 5, count = 37;
    thread_pool alone, several(3);
    input_batch one(size, alone), many(size, several);
    const auto make = [](std::size_t i, std::span<float> counts) {
        for (std::size_t e = 0; e < counts.size(); ++e)
            counts[e] = static_cast<float>(i * 7 + e);
    };
    one.scale_by(1.0F / 255), many.scale_by(1.0F / 255);
    one.fill(count, make);
    std::array<const float*, count> at{}; // where each image was made
    many.fill(count, [&](std::size_t i, std::span<float> counts) {
        at[i] = counts.data();
        make(i, counts);
    });
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t t = 0; t < several.threads(); ++t) {
            const thread_pool::share share{t, several.threads()};
            // No two threads at one place, where they would write into each other's images.
            CHECK((i >= share.begin(count) && i < share.end(count)) == (at[i] == at[share.begin(count)]));
        }
    REQUIRE(many.samples().samples() == count);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t e = 0; e < size; ++e) {
            CHECK(one.samples()(i, e) == static_cast<float>(i * 7 + e) * (1.0F / 255));
            CHECK(many.samples()(i, e) == one.samples()(i, e));
        }
}
