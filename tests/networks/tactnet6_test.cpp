#include <tactnet/networks/tactnet6.hpp>

#include <doctest/doctest.h>

#include <networks/every_size.hpp>
#include <type_traits>

using namespace tactnet;
using support::halved;

// As published.
static_assert(tactnet6<shape{28, 50, 1}, 22>::parameters == 104518);
static_assert(tactnet6<shape{28, 50, 1}, 22>::multiply_adds == 2214080);
static_assert(tactnet6<shape{28, 50, 1}, 22>::multiply_adds_on_pixels == 1717696);
static_assert(tactnet6<shape{20, 35, 1}, 22>::multiply_adds == 3113696);
static_assert(tactnet6<shape{20, 35, 1}, 22>::multiply_adds_on_pixels == 2688368);
static_assert(tactnet6<shape{14, 25, 1}, 22>::multiply_adds == 1676400);
static_assert(tactnet6<shape{14, 25, 1}, 22>::multiply_adds_on_pixels == 1361408);
static_assert(tactnet6<shape{10, 18, 1}, 22>::multiply_adds == 10795680);
static_assert(tactnet6<shape{10, 18, 1}, 22>::multiply_adds_on_pixels == 9897856);
static_assert(tactnet6<shape{7, 13, 1}, 22>::multiply_adds == 5457816);
static_assert(tactnet6<shape{7, 13, 1}, 22>::multiply_adds_on_pixels == 4822008);

// The kernel that the paper's text gives.
static_assert(tactnet6<shape{28, 50, 1}, 22, tactnet6_form{.kernel2 = 5}>::parameters ==
              104518 + 16 * 8 * (25 - 9));

// The economical ones cost less at every step down, and at full resolution are TactNet-6 itself.
template <std::size_t Rows, std::size_t Columns>
constexpr std::size_t economical = tactnet6_economical<shape{Rows, Columns, 1}, 22>::multiply_adds;
static_assert(economical<28, 50> == 2214080);
static_assert(economical<5, 5> < economical<7, 13>); // below the published range, and the least that there is
static_assert(std::is_same_v<tactnet6_economical<shape{28, 50, 1}, 22>, tactnet6<shape{28, 50, 1}, 22>>);
static_assert(std::is_same_v<tactnet6_economical<shape{21, 35, 1}, 22>, tactnet6<shape{21, 35, 1}, 22>>);
static_assert(!std::is_same_v<tactnet6_economical<shape{20, 35, 1}, 22>, tactnet6<shape{20, 35, 1}, 22>>);
static_assert(economical<28, 50> > economical<20, 35> && economical<20, 35> > economical<14, 25> &&
              economical<14, 25> > economical<10, 18> && economical<10, 18> > economical<7, 13>);

namespace {

template <shape Size>
struct binds {
    using net = tactnet6<Size, 22>;
    static constexpr bool within(std::size_t rows, std::size_t columns) {
        return Size.rows <= rows && Size.columns <= columns;
    }
    static constexpr std::size_t first = within(20, 35) ? 1 : 2, others = within(10, 18) ? 1 : 2;
    static constexpr std::size_t k5 = within(20, 35) ? 4 : 9;
    static constexpr std::size_t filters[6] = {1, 8, 16, 32, 64, 128}, taps[6] = {0, 25, 9, 9, 9, k5};
    static constexpr bool value = [] {
        std::size_t rows = Size.rows, columns = Size.columns, parameters = 0, multiply_adds = 0;
        for (std::size_t i = 1; i <= 5; ++i) {
            parameters += filters[i] * (filters[i - 1] * taps[i] + 1) + 2 * filters[i];
            multiply_adds += rows * columns * filters[i] * filters[i - 1] * taps[i];
            rows = halved(rows, i == 1 ? first : others), columns = halved(columns, i == 1 ? first : others);
        }
        return net::outputs == 22 && net::statistics == 2 * 248 &&
               net::parameters == parameters + 22 * (rows * columns * 128 + 1) &&
               net::multiply_adds == multiply_adds + 22 * rows * columns * 128 &&
               net::multiply_adds_on_pixels <= net::multiply_adds;
    }();
};

/// Only the windows of its pools differ from those of tactnet6_economical, which cost nothing.
template <shape Size>
struct costs_as_economical {
    using symmetric = tactnet6_symmetric<Size, 22>;
    using economical = tactnet6_economical<Size, 22>;
    static constexpr bool value = symmetric::outputs == 22 &&
                                  symmetric::parameters == economical::parameters &&
                                  symmetric::multiply_adds == economical::multiply_adds &&
                                  symmetric::activation_bytes == economical::activation_bytes;
};

} // namespace

static_assert(support::holds_at_every_size<binds>);
static_assert(support::holds_at_every_size<costs_as_economical>);

TEST_CASE("tactnet6: the published form at the published sizes") {
    const auto form = [](std::size_t rows, std::size_t columns) {
        const tactnet6_form f = tactnet6_form::at({rows, columns, 1});
        return f.kernel2 * 1000 + f.kernel5 * 100 + f.first_pool_stride * 10 + f.other_pools_stride;
    };
    CHECK(form(28, 50) == 3322);
    CHECK(form(20, 35) == 3212);
    CHECK(form(14, 25) == 3212);
    CHECK(form(10, 18) == 3211);
    CHECK(form(7, 13) == 3211);
    // One tactel more in either direction is the next form.
    CHECK(form(11, 18) == 3212);
    CHECK(form(10, 19) == 3212);
    CHECK(form(21, 35) == 3322);
    CHECK(form(20, 36) == 3322);
}
