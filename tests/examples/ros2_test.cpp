#include <tactnet/io.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <recognise/pliers.hpp>
#include <ros2/touch_core.hpp>
#include <vector>

// The core of the ROS 2 node, without ROS.

namespace {

using net = tactnet::tactnet4<tactnet::shape{14, 25}, 22>;
constexpr std::size_t rows = 14, columns = 25, step = 32; // ROS pads rows as a camera does

std::vector<std::uint8_t> message(std::span<const std::uint8_t> counts) {
    std::vector<std::uint8_t> data(rows * step, 255); // padding must not be read
    for (std::size_t row = 0; row < rows; ++row)
        std::copy_n(counts.data() + row * columns, columns, data.data() + row * step);
    return data;
}

} // namespace

TEST_SUITE("ros2") {
    TEST_CASE("touch_core: learns air, names a touch, and forgets it in air") {
        touch_core<net> core(tactnet::load_deployed<net>(TACTNET_SIMULATED_WEIGHTS), 10);
        const std::vector<std::uint8_t> air = message(std::vector<std::uint8_t>(rows * columns, 1)),
                                        touch = message(pliers);
        const auto read = [&](const std::vector<std::uint8_t>& data) {
            return core.read(rows, columns, step, data);
        };
        for (int frame = 0; frame < 10; ++frame)
            CHECK_FALSE(read(air));
        REQUIRE(read(air));
        CHECK_FALSE(read(air)->touching);
        for (int frame = 0; frame < 4; ++frame)
            (void)read(touch);
        const auto report = read(touch);
        REQUIRE(report);
        CHECK(report->touching);
        CHECK(report->label == "pliers");
        CHECK(report->probability > 0.8);
        for (int frame = 0; frame < 4; ++frame)
            (void)read(air);
        CHECK_FALSE(read(air)->touching);
        CHECK(read(air)->label.empty());
    }

    TEST_CASE("touch_core: returns nothing for an image of another size") {
        touch_core<net> core(tactnet::load_deployed<net>(TACTNET_SIMULATED_WEIGHTS), 0);
        const std::vector<std::uint8_t> data(rows * step);
        CHECK(core.read(rows, columns, step, data));
        CHECK_FALSE(core.read(rows - 1, columns, step, data));
        CHECK_FALSE(core.read(rows, columns + 1, step, data));
        CHECK_FALSE(core.read(rows, columns, columns - 1, data));
        CHECK_FALSE(core.read(rows, columns, 0, data));
        CHECK_FALSE(core.read(rows, columns, step, std::span(data).first(rows * step - step)));
        CHECK_FALSE(core.read(rows, columns, step, {}));
    }
}
