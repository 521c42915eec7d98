#include <tactnet/networks/tactresnet.hpp>

#include <doctest/doctest.h>

#include <networks/every_size.hpp>

using namespace tactnet;

// As published.
static_assert(tactresnet<shape{28, 50, 1}, 22>::parameters == 786838);
static_assert(tactresnet<shape{28, 50, 1}, 22>::multiply_adds == 53689216);
static_assert(tactresnet<shape{28, 50, 1}, 22>::multiply_adds_on_pixels == 45132672);

namespace {

template <shape Size>
struct binds {
    using net = tactresnet<Size, 22>;
    static constexpr bool value = [] {
        const tactresnet_form f = tactresnet_form::at(Size);
        const auto pooled = [&](std::size_t size) {
            return ((size + 1) / 2 - f.first_pool) / f.first_pool_stride + 1;
        };
        const std::size_t rows = pooled(Size.rows), columns = pooled(Size.columns);
        const std::size_t last_rows = rows - f.last_pool + 1, last_columns = columns - f.last_pool + 1;
        const auto conv = [](std::size_t from, std::size_t to) { return to * (from * 9 + 1) + 2 * to; };
        const std::size_t parameters = 64 * 26 + 128 + 4 * conv(64, 64) + 2 * conv(64, 128) +
                                       3 * conv(128, 128) + 22 * (last_rows * last_columns * 128 + 1);
        const std::size_t first = (Size.rows + 1) / 2 * ((Size.columns + 1) / 2) * 64 * 25;
        const std::size_t blocks = rows * columns * 9 * (4 * 64 * 64 + 2 * 64 * 128 + 3 * 128 * 128);
        return rows >= f.last_pool && columns >= f.last_pool && net::outputs == 22 &&
               net::parameters == parameters &&
               net::multiply_adds == first + blocks + 22 * last_rows * last_columns * 128;
    }();
};

} // namespace

static_assert(support::holds_at_every_size<binds>);

TEST_CASE("tactresnet: pools shrink with the image and never grow back") {
    const tactresnet_form published = tactresnet_form::at({28, 50, 1});
    CHECK(published.first_pool == 3);
    CHECK(published.first_pool_stride == 2);
    CHECK(published.last_pool == 5);
    tactresnet_form before = tactresnet_form::at({7, 13, 1});
    CHECK(before.first_pool == 1);
    for (std::size_t rows = 8; rows <= 28; ++rows) {
        const tactresnet_form form = tactresnet_form::at({rows, 50, 1});
        CHECK(form.first_pool >= before.first_pool);
        CHECK(form.first_pool_stride <= form.first_pool);
        before = form;
    }
}
