#include <tactnet/simulation/effects/film/gain_map.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <simulation/effect_frames.hpp>
#include <span>
#include <vector>

using namespace tactnet;
using simulation::gain_map;

namespace {

constexpr shape size{28, 50};

support::frame<size> gains_of(std::uint64_t sensor, double deviation = 0.3) {
    return support::after<size>(gain_map{deviation}, support::filled<size>(1), {}, {.unit = {sensor}});
}

} // namespace

TEST_CASE("gain_map: mean one, the given deviation, skewed as the paper's sensor") {
    constexpr std::uint64_t sensors = 100;
    constexpr double n = size.size() * sensors;
    std::vector<double> gains;
    double sum = 0, squares = 0, neighbours = 0;
    for (std::uint64_t sensor = 0; sensor < sensors; ++sensor) {
        const auto drawn = gains_of(sensor);
        for (std::size_t i = 0; i < size.size(); ++i) {
            const double gain = static_cast<double>(drawn.data()[i]);
            gains.push_back(gain);
            sum += gain, squares += (gain - 1) * (gain - 1);
            neighbours += i > 0 ? (gain - 1) * (static_cast<double>(drawn.data()[i - 1]) - 1) : 0;
        }
    }
    CHECK(std::abs(sum / n - 1) < 5 * 0.3 / std::sqrt(n));
    // A log-normal number of this deviation has the kurtosis 4.64, so that its variance scatters by √(3.64 /
    // n).
    CHECK(std::abs(squares / n / 0.09 - 1) < 5 * std::sqrt(3.64 / n));
    CHECK(std::abs(neighbours / n) < 5 * 0.09 / std::sqrt(n));
    // Measured on the paper's images; a log-normal distribution is that within a tenth.
    std::sort(gains.begin(), gains.end());
    const double measured[][2]{{0.01, -0.59}, {0.05, -0.44}, {0.25, -0.23}, {0.5, -0.07},
                               {0.75, 0.13},  {0.95, 0.47},  {0.99, 0.81}};
    for (const auto& [share, gain] : measured)
        CHECK(std::abs(gains[static_cast<std::size_t>(share * n)] - 1 - gain) < 0.1);
}
TEST_CASE("gain_map: multiplies every tactel by its gain, and nothing past the last") {
    const gain_map::bound<size> bound({}, {.unit = {1}});
    std::vector<float> values(size.size() + 1, 2.0F);
    bound.apply(tensor_view<float, size>(std::span<float, size.size()>(values.data(), size.size())), {});
    for (std::size_t i = 0; i < size.size(); ++i)
        CHECK(values[i] == 2 * bound.gains().data()[i]);
    CHECK(values.back() == 2.0F);
    CHECK(bound.gains().data()[0] != 1.0F);
}
TEST_CASE("gain_map: stays with the sensor, frame after frame") {
    CHECK(support::same_bits(gains_of(1), gains_of(1)));
    CHECK_FALSE(support::same_bits(gains_of(1), gains_of(2)));
    gain_map::bound<size> bound({}, {.unit = {1}});
    for (std::uint32_t frame = 0; frame < 2; ++frame) {
        auto values = support::filled<size>(2);
        bound.apply(values.view(), {.seed = frame, .frame = frame, .seconds = 9});
        for (std::size_t i = 0; i < size.size(); ++i)
            CHECK(values.data()[i] == 2 * gains_of(1).data()[i]);
    }
}
TEST_CASE("gain_map: zero and impossible deviations change no bit, and finite readings never give NaN") {
    support::check_changes_no_bit<size>(gain_map{0});
    support::check_changes_no_bit<size>(gain_map{-1});
    support::check_changes_no_bit<size>(gain_map{std::numeric_limits<double>::quiet_NaN()});
    support::check_no_nan<size>(gain_map{});
    support::check_no_nan<size>(gain_map{1e300});
}
