#include <tactnet/sensors/calibration.hpp>
#include <tactnet/sensors/frame.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/sensors/warning.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <support/allocations.hpp>
#include <vector>

namespace {

using tactnet::calibration;
using tactnet::decoding_warning;
using tactnet::decoding_warnings;
using tactnet::frame_view;
using tactnet::shape;
using tactnet::tekscan_6077;
using tactnet::warning_text;

TEST_CASE("frame: cells in a size known when compiling") {
    const std::array<float, 6> cells{0, 1, 2, 3, 254, 255};
    const frame_view frame{1, 0.5, 2, 3, cells};
    CHECK(frame(1, 0) == 3);
    CHECK(frame(1, 1) == 254);
    const auto view = frame.as<shape{2, 3, 1}>();
    REQUIRE(view);
    CHECK((*view)(1, 2) == 255);
    CHECK(view->data() == cells.data());
    CHECK(!frame.as<shape{3, 2, 1}>());
    CHECK(!frame.as<shape{2, 2, 1}>());
    CHECK(!frame_view{1, {}, 2, 3, std::span(cells).first(5)}.as<shape{2, 3, 1}>());
}

TEST_CASE("frame: 8-bit counts, where the cells are") {
    std::array<float, 2> cells{7, 255};
    const frame_view frame{1, {}, 1, 2, cells};
    const auto counts = frame.counts<shape{1, 2, 1}>();
    REQUIRE(counts);
    CHECK((*counts)(0, 0) == 7);
    CHECK((*counts)(0, 1) == 255);
    CHECK(!frame.counts<shape{2, 1, 1}>());
    for (const float other : {255.5F, 256.F, -1.F, 0.5F, std::nanf("")}) {
        cells[1] = other;
        CHECK(!frame.counts<shape{1, 2, 1}>());
    }
}

TEST_CASE("warning_text: texts and numbers, cut off where they are too long") {
    CHECK(warning_text().view().empty());
    CHECK(warning_text("cell ", 12U, " at ", 0.25, " s").view() == "cell 12 at 0.25 s");
    CHECK(warning_text(UINT64_MAX, -3).view() == "18446744073709551615-3");
    const std::string long_text(warning_text::capacity - 1, 'x');
    CHECK(warning_text(std::string_view(long_text), "yz", 1).view() == long_text + "y");
}

TEST_CASE("decoding_warnings: the first are kept, all are counted, and no heap is used") {
    decoding_warnings warnings;
    CHECK(warnings.count() == 0);
    CHECK(warnings.kept().empty());
    const std::size_t before = support::bytes_allocated();
    for (std::size_t i = 0; i < 1000; ++i)
        warnings.add({i, 0, 2, warning_text("a count of at least ", 3U), warning_text(i)});
    CHECK(support::bytes_allocated() == before);
    CHECK(warnings.count() == 1000);
    REQUIRE(warnings.kept().size() == decoding_warnings::capacity);
    CHECK(warnings.kept()[15] ==
          decoding_warning{15, 0, 2, warning_text("a count of at least 3"), warning_text("15")});
    CHECK(warnings.kept()[15].place() == "byte 15, frame 2");
    CHECK(decoding_warning{7, 3, 0, {}, {}}.place() == "byte 7, line 3");
    CHECK(warnings.kept()[15].message() == "byte 15, frame 2: expected a count of at least 3, found 15");
    CHECK(warnings.kept()[15].message("a.fsx") ==
          "a.fsx: byte 15, frame 2: expected a count of at least 3, found 15");
}

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
    const std::vector<float> infinite{50, std::numeric_limits<float>::infinity(), 0, 150},
        least{1e38F, 1e-38F, 0, 1};
    description.mask = {1, 1, 0, 1};
    CHECK_THROWS_AS(static_cast<void>(equilibration_gains(infinite, description)), std::invalid_argument);
    constexpr float most = std::numeric_limits<float>::max(), nan = std::numeric_limits<float>::quiet_NaN();
    CHECK(equilibration_gains(least, description)[1] == most);
    // A broken cell stays one; pressures are finite.
    CHECK(even.to_pascal(std::vector<float>{nan, most, 0, 1}, pascal));
    CHECK(std::isnan(pascal[0]));
    CHECK(calibration({.saturation_pressure = 1e300, .full_scale = 1e-300}).to_pascal(least, pascal));
    CHECK(pascal == std::vector<float>{most, most, 0, most});
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
    description.full_scale = 1000;
    CHECK(calibration::from(description)->to_pascal(counts, pascal));
    CHECK(pascal[0] == 51);
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

static_assert(tekscan_6077::extents == tactnet::shape{28, 50, 1});
static_assert(tekscan_6077::saturation_pressure == 34'000);
static_assert(tekscan_6077::tactels_per_area == 276'000);

TEST_CASE("tekscan_6077: the pitch is that of the published density, in whole micrometres") {
    CHECK(std::round(1e6 / std::sqrt(tekscan_6077::tactels_per_area)) ==
          std::round(tekscan_6077::pitch * 1e6));
    CHECK(tekscan_6077::pitch == 1.903e-3);
}

TEST_CASE("tekscan_6077: the last count is its saturation pressure") {
    CHECK(tactnet::calibration::for_6077().values().saturation_pressure == tekscan_6077::saturation_pressure);
}

} // namespace
