#include <tactnet/training/data/sample_batch.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

using namespace tactnet;

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
