#include <tactnet/decision/contact_detector.hpp>
#include <tactnet/decision/sensor_health.hpp>
#include <tactnet/io/images/set.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <decode_image.hpp>
#include <span>
#include <support/files/data_folder.hpp>

using namespace tactnet;

TEST_CASE("decision: every real image is a contact, and none has a tactel that looks faulty" *
          doctest::test_suite("data")) {
    constexpr shape array{28, 50};
    const auto root = support::find_data("tactile_images");
    if (!root)
        return;
    const image_set images = load_images(list_image_folder(*root), array.rows, array.columns, decode_image);
    REQUIRE(images.labels.size() == 1100);
    sensor_health<array> sensor;
    contact_detector<array> detector;
    std::size_t changed = 0, contacts = 0;
    for (std::size_t i = 0; i < images.labels.size(); ++i) {
        const auto raw = std::span(images.pixels).subspan(i * array.size()).first<array.size()>();
        const auto clean = sensor.clean(raw);
        changed += !std::equal(raw.begin(), raw.end(), clean.begin());
        for (int frame = 0; frame < 2; ++frame)
            (void)detector.update(raw);
        contacts += detector.now().touching;
        for (int frame = 0; frame < 3; ++frame)
            (void)detector.update(std::array<std::uint8_t, array.size()>{});
        CHECK_FALSE(detector.now().touching);
    }
    CHECK(changed == 0);
    CHECK(contacts == 1100);
    CHECK(sensor.faults().empty());
}
