#include <tactnet/tensor/batch.hpp>
#include <tactnet/training/data/sample_batch.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>

using namespace tactnet;

TEST_CASE("sample_batch: has no sample unless told") {
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
