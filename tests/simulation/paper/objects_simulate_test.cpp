#include "../witness.hpp"

#include <tactnet/simulation/paper/objects.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <cstdint>
#include <set>

namespace {

using namespace support;

TEST_CASE("simulate: each touch of the paper's classes has a sensor and random numbers of its own, to the "
          "seed's last bit") {
    watched scene;
    watched::frames result;
    std::set<std::uint64_t> sensors;
    std::size_t touches = 0;
    for (const std::uint64_t seed : {0ull, 1ull, 1ull << 32, ~0ull})
        for (const std::size_t label : {0u, 1u, 21u})
            for (const std::uint32_t number : {0u, 1u, 7u}) {
                simulate_paper_touch(scene, label, seed, number, result);
                CHECK(said(result, 1) == said(result, 0));
                CHECK(said(result, 2) == number);
                sensors.insert(said(result, 0));
                ++touches;
            }
    CHECK(sensors.size() == touches);
}

} // namespace
