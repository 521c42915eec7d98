#include <tactnet/sensors/tekscan/line.hpp>

#include <doctest/doctest.h>

#include <cstdint>
#include <optional>

namespace {

using tactnet::tekscan_frame_line;
using tactnet::tekscan_frame_times;

tekscan_frame_line line(std::uint64_t number, std::optional<double> stamp = {},
                        std::optional<double> unit = {}) {
    tekscan_frame_line result;
    result.number = number;
    result.stamp = stamp;
    result.stamp_unit = unit;
    return result;
}

TEST_CASE("tekscan_frame_times: without a time, frames are as far apart as the header says") {
    tekscan_frame_times times;
    times.begin(line(7));
    CHECK(times.seconds(line(7), 0, 0.25) == 0.0);
    CHECK(times.seconds(line(11), 1, 0.25) == 1.0);
    CHECK(times.seconds(line(11), 1, std::nullopt) == std::nullopt);
}

TEST_CASE("tekscan_frame_times: a time with a unit is taken as it is") {
    tekscan_frame_times times;
    times.begin(line(1, 500.0, 1e-3));
    CHECK(times.seconds(line(1, 500.0, 1e-3), 0, 0.25) == 0.5);
    CHECK(times.seconds(line(2, 2.0, 1.0), 1, 0.25) == 2.0);
}

TEST_CASE(
    "tekscan_frame_times: without a unit, seconds unless the header shows milliseconds, and it stays so") {
    tekscan_frame_times seconds, milliseconds, unknown;
    for (tekscan_frame_times* const times : {&seconds, &milliseconds, &unknown})
        times->begin(line(1, 0.0));
    CHECK(seconds.seconds(line(1, 0.0), 0, 0.5) == 0.0);
    CHECK(seconds.seconds(line(3, 1.0), 1, 0.5) == 1.0);
    CHECK(milliseconds.seconds(line(3, 1000.0), 1, 0.5) == 1.0);
    CHECK(milliseconds.seconds(line(4, 4.0), 2, 0.5) == 0.004);
    CHECK(unknown.seconds(line(3, 1000.0), 1, std::nullopt) == 1000.0);
}

} // namespace
