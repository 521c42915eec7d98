#include <tactnet/networks/tactnet4.hpp>

#include <doctest/doctest.h>

#include <networks/every_size.hpp>

using namespace tactnet;
using support::halved;

// As published.
static_assert(tactnet4<shape{28, 50, 1}, 22>::parameters == 25862);
static_assert(tactnet4<shape{28, 50, 1}, 22>::multiply_adds == 1122240);
static_assert(tactnet4<shape{28, 50, 1}, 22>::multiply_adds_on_pixels == 1014976);
static_assert(tactnet4<shape{7, 13, 1}, 22>::multiply_adds == 88728);
static_assert(tactnet4<shape{7, 13, 1}, 22>::multiply_adds_on_pixels == 59896);
static_assert(tactnet4<shape{14, 25, 1}, 22>::input_shape == shape{14, 25, 1});

// Kernels of 3 x 3 at every size.
static_assert(tactnet4_3x3<shape{8, 16}, 22>::parameters == 7430);
static_assert(tactnet4_3x3<shape{8, 16}, 22>::multiply_adds == 84352);
static_assert(tactnet4_3x3<shape{14, 25}, 22>::parameters == 11654);
static_assert(tactnet4_3x3<shape{14, 25}, 22>::multiply_adds == 264688);
static_assert(!tactnet4_3x3_training({8, 16}).has_value());

// A stride in place of the first pool, with symmetric windows: 8 filters of 4 x 5 taps.
static_assert(tactnet4_strided<shape{14, 25}, 22>::parameters == 11742);
static_assert(tactnet4_strided<shape{14, 25}, 22>::multiply_adds == 254048);
static_assert(tactnet4_strided<shape{12, 22}, 22>::multiply_adds == 171648);
static_assert(tactnet4_strided<shape{5, 5}, 22>::output_shape.size() == 22);

// Outside the published range: larger images take the full form, smaller ones that of 7 x 13.
static_assert(within_published_range({7, 13}) && within_published_range({28, 50}) &&
              within_published_range({50, 28}));
static_assert(!within_published_range({64, 64}) && !within_published_range({29, 50}) &&
              !within_published_range({6, 13}) && !within_published_range({12, 12}) &&
              !within_published_range({5, 5}));
static_assert(tactnet4<shape{64, 64}, 22>::parameters ==
              tactnet4<shape{28, 50}, 22>::parameters + 22 * 32 * (8 * 8 - 4 * 7));
static_assert(tactnet4<shape{5, 5}, 22>::output_shape.size() == 22);

namespace {

template <shape Size>
struct binds {
    using net = tactnet4<Size, 22>;
    // The published kernels hold where the size is within that resolution and not within a smaller one.
    static constexpr bool is_14x25 =
        Size.rows <= 14 && Size.columns <= 25 && !(Size.rows <= 10 && Size.columns <= 18);
    static constexpr std::size_t k1 = is_14x25 ? 9 : 25, k2 = is_14x25 ? 4 : 9;
    static constexpr std::size_t convolutions = 8 * (k1 + 1) + 16 * (8 * k2 + 1) + 32 * (16 * k2 + 1);
    static constexpr std::size_t dense_inputs =
        32 * halved(halved(halved(Size.rows))) * halved(halved(halved(Size.columns)));
    static constexpr std::size_t multiply_adds =
        Size.area() * 8 * k1 + halved(Size.rows) * halved(Size.columns) * 16 * 8 * k2 +
        halved(halved(Size.rows)) * halved(halved(Size.columns)) * 32 * 16 * k2 + dense_inputs * 22;
    static constexpr bool value =
        net::outputs == 22 && net::parameters == convolutions + 2 * (8 + 16 + 32) + 22 * (dense_inputs + 1) &&
        net::statistics == 2 * (8 + 16 + 32) && net::multiply_adds == multiply_adds &&
        net::multiply_adds_on_pixels <= multiply_adds;
};

} // namespace

static_assert(support::holds_at_every_size<binds>);

TEST_CASE("tactnet4: the published form at the published sizes") {
    const auto kernels = [](std::size_t rows, std::size_t columns) {
        const tactnet4_form f = tactnet4_form::at({rows, columns, 1});
        return f.kernel1 * 100 + f.kernel2 * 10 + f.kernel3;
    };
    CHECK(kernels(28, 50) == 533);
    CHECK(kernels(20, 35) == 533);
    CHECK(kernels(14, 25) == 322);
    CHECK(kernels(10, 18) == 533);
    CHECK(kernels(7, 13) == 533);
}
