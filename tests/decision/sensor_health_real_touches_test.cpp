#include "touches_by_size.hpp"

#include <doctest/doctest.h>

#include <decode_image.hpp>
#include <support/files/data_folder.hpp>
#include <type_traits>

namespace {

using namespace tactnet;

const auto at_every_size = [](const auto& check) {
    check(std::integral_constant<shape, shape{28, 50}>{});
    check(std::integral_constant<shape, shape{20, 35}>{});
    check(std::integral_constant<shape, shape{14, 25}>{});
    check(std::integral_constant<shape, shape{16, 16}>{});
    check(std::integral_constant<shape, shape{10, 18}>{});
    check(std::integral_constant<shape, shape{7, 13}>{});
};

} // namespace

TEST_CASE("decision: at every size, each real touch is felt, stays as it is, and is not taken for air" *
          doctest::test_suite("data")) {
    const auto root = support::find_data("tactile_images");
    if (!root)
        return;
    const image_set images = load_images(list_image_folder(*root), 28, 50, decode_image);
    at_every_size([&]<shape Array>(std::integral_constant<shape, Array>) {
        CAPTURE(Array.rows);
        const auto found = touches_by_size::of_touches<Array>(images);
        CHECK(found.touches == 1100);
        CHECK(found.felt == 1100);
        CHECK(found.altered == 0);
        CHECK(found.held == 1);
    });
}

TEST_CASE("decision: at every size, the noise of air is no contact, once it was learnt") {
    at_every_size([]<shape Array>(std::integral_constant<shape, Array>) {
        CAPTURE(Array.rows);
        for (const double deviation : {1.5, 6.0})
            CHECK(touches_by_size::contacts_in_air<Array>(deviation, 100'000, 1) == 0);
    });
    CHECK(touches_by_size::contacts_in_air<shape{4, 4}>(6, 100'000, 1) ==
          0); // where a tactel begins a contact
}
