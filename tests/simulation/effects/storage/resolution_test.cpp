#include <tactnet/image/resize.hpp>
#include <tactnet/simulation/effects/storage/resolution.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ratio>
#include <simulation/effect_frames.hpp>

using namespace tactnet;
using simulation::resolution;

namespace {

constexpr shape full{28, 50}, half{14, 25};
static_assert(simulation::output_shape<resolution<14, 25>, full>() == half);

} // namespace

TEST_CASE("resolution: whole counts, as the resized image stored in bytes") {
    const auto counts = support::pressed<full>(0, 255);
    tensor<std::uint8_t, half> expected;
    resize<full, half>(counts.view(), expected.view());
    support::frame<half> resized;
    const resolution<14, 25>::bound<full> bound({}, {});
    bound.apply(counts.view(), resized.view(), {});
    for (std::size_t i = 0; i < half.size(); ++i)
        CHECK(resized.data()[i] == static_cast<float>(expected.data()[i]));
}
TEST_CASE("resolution: no overshoot beyond the counts") {
    auto counts = support::filled<full>(0);
    for (std::size_t i = 0; i < full.size(); ++i)
        counts.data()[i] = i / full.columns < 14 ? 14.0f : 0.0f;
    support::frame<shape{56, 100}> resized;
    const resolution<56, 100, keys_cubic<std::ratio<-1, 2>, false>>::bound<full> bound({.last = 14}, {});
    bound.apply(counts.view(), resized.view(), {});
    for (const float count : resized)
        CHECK((count >= 0 && count <= 14 && count == std::floor(count)));
}
TEST_CASE("resolution: the same size changes no bit") {
    support::check_changes_no_bit<shape{5, 7}>(resolution<5, 7>{});
}
