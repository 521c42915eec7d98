#include <tactnet/deployment/deployed_view.hpp>

#include <doctest/doctest.h>

#include <array>
#include <limits>

using namespace tactnet;

TEST_CASE("output_stage: channels come one after the other, without what stands between pixels") {
    using output = output_stage<single_precision, shape{1, 2, 3}, 4>;
    const std::array<float, 8> map{1, 2, 3, -1, 4, 5, 6, -1};
    std::array<float, 6> out{};
    CHECK(output::write(map.data(), out));
    CHECK(out == std::array<float, 6>{1, 4, 2, 5, 3, 6});
}

TEST_CASE("output_stage: a NaN or an infinity at any place is reported") {
    using output = output_stage<single_precision, shape{1, 1, 3}, 4>;
    constexpr float largest = std::numeric_limits<float>::max();
    std::array<float, 3> out{};
    std::array<float, 4> map{largest, -largest, 0, std::numeric_limits<float>::quiet_NaN()};
    CHECK(output::write(map.data(), out)); // what is no output does not count
    for (const float broken :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
          -std::numeric_limits<float>::infinity()})
        for (std::size_t place = 0; place < 3; ++place) {
            map = {1, 2, 3, 0};
            map[place] = broken;
            CHECK(!output::write(map.data(), out));
        }
}
