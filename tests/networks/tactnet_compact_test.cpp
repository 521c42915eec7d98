#include <tactnet/networks/tactnet_compact.hpp>

#include <doctest/doctest.h>

#include <array>
#include <networks/every_size.hpp>
#include <networks/learns.hpp>

using namespace tactnet;
using support::halved;

namespace {

/// Counted from the list by hand: kernels, biases, scales and shifts; all taps.
template <shape Size>
struct binds {
    using net = tactnet_compact<Size, 22>;
    static constexpr std::size_t filters[7] = {1, 16, 32, 48, 48, 48, 96};
    static constexpr bool value = [] {
        std::size_t rows = Size.rows, columns = Size.columns, parameters = 0, multiply_adds = 0;
        for (std::size_t i = 1; i <= 6; ++i) {
            parameters += filters[i] * (filters[i - 1] * 9 + 1) + 2 * filters[i];
            multiply_adds += rows * columns * filters[i] * filters[i - 1] * 9;
            if (i <= 3 && halved(rows) >= 3 && halved(columns) >= 3)
                rows = halved(rows), columns = halved(columns);
        }
        return net::parameters == parameters + 22 * (4 * 96 + 1) && net::parameters <= 150'000 &&
               net::multiply_adds == multiply_adds + 22 * 4 * 96 && net::takes_counts;
    }();
};

} // namespace

static_assert(support::holds_at_every_size<binds>);
static_assert(tactnet_compact<shape{28, 50}, 22>::multiply_adds == 5'403'264);
static_assert(tactnet_compact<shape{7, 13}, 22>::parameters ==
              tactnet_compact<shape{28, 50}, 22>::parameters);

TEST_CASE("tactnet_compact: pools while three rows and columns remain, then bins of 2 × 2") {
    const auto form = [](std::size_t rows, std::size_t columns) {
        const auto f = tactnet_compact_form::at({rows, columns});
        return std::array{f.first_pool,          f.second_pool,      f.third_pool,         f.last_window.rows,
                          f.last_window.columns, f.last_stride.rows, f.last_stride.columns};
    };
    using numbers = std::array<std::size_t, 7>;
    CHECK(form(28, 50) == numbers{2, 2, 2, 2, 4, 2, 3});
    CHECK(form(20, 35) == numbers{2, 2, 2, 2, 3, 1, 2});
    CHECK(form(14, 25) == numbers{2, 2, 1, 2, 4, 2, 3});
    CHECK(form(7, 13) == numbers{2, 1, 1, 2, 4, 2, 3});
    CHECK(form(1, 1) == numbers{1, 1, 1, 1, 1, 1, 1});
}

TEST_CASE_TEMPLATE("tactnet_compact: learns at any size", Network, tactnet_compact<shape{7, 13}, 5>,
                   tactnet_compact<shape{28, 50}, 5>, tactnet_compact<shape{11, 38}, 5>) {
    support::check_learns<Network>();
}
