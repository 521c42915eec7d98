#include <tactnet/networks/tactnet4_strided.hpp>

#include <array>
#include <cstddef>
#include <networks/every_size.hpp>

using namespace tactnet;
using support::halved;

static_assert(tactnet4_strided<shape{14, 25}, 22>::parameters == 11742);
static_assert(tactnet4_strided<shape{14, 25}, 22>::multiply_adds == 254048);
static_assert(tactnet4_small<shape{14, 25}, 22>::parameters == 16542);
static_assert(tactnet4_small<shape{14, 25}, 22>::multiply_adds == 210944);
static_assert(tactnet4_strided<shape{5, 5}, 22>::output_shape.size() == 22);

namespace {

/// A side of the image, halved 0 to 4 times.
constexpr std::array<std::size_t, 5> halvings_of(std::size_t size) {
    std::array<std::size_t, 5> sizes{size};
    for (std::size_t i = 1; i < sizes.size(); ++i)
        sizes[i] = halved(sizes[i - 1]);
    return sizes;
}

/// The costs of one of the networks, whose second and third convolutions and dense layer see the image halved
/// as often.
template <class Network>
constexpr bool costs_as_expected(tactnet4_filters filters, std::size_t second, std::size_t third,
                                 std::size_t last) {
    constexpr shape size = Network::input_shape;
    const auto [f1, f2, f3] = filters;
    const auto rows = halvings_of(size.rows), columns = halvings_of(size.columns);
    const std::size_t taps = (4 + size.rows % 2) * (4 + size.columns % 2);
    const std::size_t inputs = f3 * rows[last] * columns[last];
    return Network::parameters == f1 * (taps + 1) + f2 * (f1 * 9 + 1) + f3 * (f2 * 9 + 1) +
                                      2 * (f1 + f2 + f3) + 22 * (inputs + 1) &&
           Network::multiply_adds == rows[1] * columns[1] * f1 * taps +
                                         rows[second] * columns[second] * f2 * f1 * 9 +
                                         rows[third] * columns[third] * f3 * f2 * 9 + inputs * 22;
}
template <shape... Size>
constexpr bool costs_as_expected_at() {
    return ((costs_as_expected<tactnet4_strided<Size, 22>>({8, 16, 32}, 1, 2, 3) &&
             costs_as_expected<tactnet4_wide<Size, 22>>({16, 24, 48}, 1, 2, 3) &&
             costs_as_expected<tactnet4_small<Size, 22>>({16, 24, 48}, 2, 3, 4)) &&
            ...);
}
static_assert(
    costs_as_expected_at<shape{28, 50}, shape{20, 35}, shape{13, 29}, shape{10, 18}, shape{7, 13}>());

} // namespace
