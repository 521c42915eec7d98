#include <tactnet/simulation/effects/circuit/noise.hpp>

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <simulation/effect_frames.hpp>

using namespace tactnet;
using simulation::noise;

namespace {

constexpr shape size{28, 50};

} // namespace

TEST_CASE("noise: has the mean and deviation of its parameters") {
    const auto check = [](const noise& effect, double pressure, double deviation) {
        constexpr std::uint32_t frames = 50;
        double sum = 0, squares = 0;
        for (std::uint32_t frame = 0; frame < frames; ++frame)
            for (const float reading : support::after<size>(
                     effect, support::filled<size>(static_cast<float>(pressure)), {.frame = frame})) {
                const double error = static_cast<double>(reading) - pressure;
                sum += error, squares += error * error;
            }
        constexpr double n = size.size() * frames;
        CHECK(std::abs(sum / n) < 5 * deviation / std::sqrt(n));
        CHECK(std::abs(squares / n / (deviation * deviation) - 1) < 5 * std::sqrt(2 / n));
    };
    check({.additive = 100, .relative = 0}, 0, 100);
    check({.additive = 100, .relative = 0}, 20e3, 100);
    check({.additive = 0, .relative = 0.05}, 20e3, 1000);
    check({.additive = 300, .relative = 0.04}, 1e4, 500);
}
TEST_CASE("noise: every seed, frame and tactel has its own, the same whenever it is drawn") {
    const auto drawn = [](std::uint64_t seed, std::uint32_t frame) {
        return support::after<size>(noise{.additive = 1, .relative = 0}, support::filled<size>(0),
                                    {.seed = seed, .frame = frame});
    };
    const auto first = drawn(1, 0);
    CHECK(support::same_bits(first, drawn(1, 0)));
    const auto correlation = [&](const support::frame<size>& other, std::size_t apart) {
        double sum = 0;
        for (std::size_t i = 0; i + apart < size.size(); ++i)
            sum += static_cast<double>(first.data()[i]) * static_cast<double>(other.data()[i + apart]);
        return sum / std::sqrt(static_cast<double>(size.size()));
    };
    for (const auto& other : {drawn(2, 0), drawn(1, 1)})
        CHECK(std::abs(correlation(other, 0)) < 5);
    for (const std::size_t apart : {1u, 49u, 50u, 51u, 100u})
        CHECK(std::abs(correlation(first, apart)) < 5);
}
TEST_CASE("noise: the same bits with every instruction set") {
    const auto readings = support::after<size>(noise{}, support::pressed<size>(), {.seed = 3, .frame = 4});
    std::uint64_t hash = 0xcbf29ce484222325; // Fowler, Noll and Vo's
    for (const float reading : readings)
        hash = (hash ^ std::bit_cast<std::uint32_t>(reading)) * 0x100000001b3;
    CHECK(hash == 907740452739619058u);
}
TEST_CASE("noise: zero and impossible deviations change no bit, and finite readings never give NaN") {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    support::check_changes_no_bit<size>(noise{.additive = 0, .relative = 0});
    support::check_changes_no_bit<size>(noise{.additive = -1, .relative = nan});
    support::check_no_nan<size>(noise{});
    support::check_no_nan<size>(noise{.additive = 0, .relative = 1e300});
    support::check_no_nan<size>(noise{.additive = 1e300, .relative = 0});
    support::check_no_nan<size>(
        noise{.additive = std::numeric_limits<double>::infinity(), .relative = 1e-30});
}
