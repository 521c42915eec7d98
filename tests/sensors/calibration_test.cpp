#include <tactnet/sensors/calibration.hpp>

#include <doctest/doctest.h>

#include <array>
#include <limits>
#include <stdexcept>
#include <vector>

using tactnet::calibration;

TEST_CASE("calibration: counts in proportion to the saturation pressure") {
    const calibration scaled({.saturation_pressure = 1000, .noise_threshold = 3});
    const std::array<float, 5> counts{0, 3, 4, 51, 255};
    std::array<float, 5> pascal{};
    CHECK(scaled.to_pascal(counts, pascal));
    CHECK(pascal == std::array<float, 5>{0, 0, static_cast<float>(4 * 1000. / 255), 200, 1000});
    std::array<float, 4> small{};
    CHECK(!scaled.to_pascal(counts, small));
}

TEST_CASE("calibration: the 6077, and the published reader's scale") {
    const std::array<float, 1> full{255};
    std::array<float, 1> pascal{};
    CHECK(calibration::for_6077().to_pascal(full, pascal));
    CHECK(pascal[0] == 34e3F);
    CHECK(calibration::for_6077(256).to_pascal(full, pascal));
    CHECK(pascal[0] == static_cast<float>(34e3 * 255 / 256));
}

TEST_CASE("calibration: gains of an equilibration make its frame even") {
    tactnet::recording_description description;
    description.rows = 1;
    description.columns = 4;
    description.mask = {1, 1, 0, 1};
    const std::vector<float> mean{50, 100, 0, 150};
    const auto gains = equilibration_gains(mean, description);
    CHECK(gains == std::vector<float>{2, 1, 1, static_cast<float>(100. / 150)});
    const calibration even({.saturation_pressure = 255, .gains = gains});
    std::vector<float> pascal(4);
    CHECK(even.to_pascal(mean, pascal));
    CHECK(pascal[0] == doctest::Approx(100));
    CHECK(pascal[1] == doctest::Approx(100));
    CHECK(pascal[2] == 0);
    CHECK(pascal[3] == doctest::Approx(100));
    description.mask = {1, 1, 1, 1};
    CHECK_THROWS_AS(static_cast<void>(equilibration_gains(mean, description)), std::invalid_argument);
    CHECK_THROWS_AS(static_cast<void>(equilibration_gains(std::vector<float>(3, 1.0F), description)),
                    std::invalid_argument);
    // Gains of another size change nothing.
    std::vector<float> three(3), to(3, -1.0F);
    CHECK(!even.to_pascal(three, to));
    CHECK(to[0] == -1);
}

TEST_CASE("calibration: a recording that names its saturation pressure") {
    tactnet::recording_description description;
    CHECK(!calibration::from(description));
    description.saturation_pressure = 0.5;
    CHECK(calibration::from(description));
    description.saturation_pressure = 0;
    CHECK(!calibration::from(description));
    description.saturation_pressure.reset();
    description.unit = tactnet::pressure_unit::raw;
    CHECK(!calibration::from(description));
    description.saturation_pressure = 510;
    const auto found = calibration::from(description);
    REQUIRE(found);
    const std::array<float, 1> counts{100};
    std::array<float, 1> pascal{};
    CHECK(found->to_pascal(counts, pascal));
    CHECK(pascal[0] == 200);
    description.unit = tactnet::pressure_unit::pascal;
    CHECK(!calibration::from(description));
}

TEST_CASE("calibration: values that make no sense") {
    CHECK_THROWS_AS(calibration({}), std::invalid_argument);
    CHECK_THROWS_AS(calibration({.saturation_pressure = 1, .full_scale = 0}), std::invalid_argument);
    CHECK_THROWS_AS(calibration({.saturation_pressure = 1, .noise_threshold = -1}), std::invalid_argument);
    CHECK_THROWS_AS(calibration({.saturation_pressure = 1, .gains = {1, 0}}), std::invalid_argument);
    CHECK_THROWS_AS(calibration({.saturation_pressure = std::numeric_limits<double>::infinity()}),
                    std::invalid_argument);
}
