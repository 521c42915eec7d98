#include <tactnet/kernels/map/hartley.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <support/guarded_map.hpp>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

std::size_t bits_reversed(std::size_t index, std::size_t size) {
    std::size_t result = 0;
    for (std::size_t bit = 1; bit < size; bit *= 2, index /= 2)
        result = 2 * result + index % 2;
    return result;
}

/// The definition, in long double.
template <std::size_t Size>
void compare() {
    CAPTURE(Size);
    constexpr std::size_t width = lanes<double>;
    std::uint64_t state = Size;
    struct alignas(64) signals {
        double sample[Size * width];
    } given{}, transformed;
    for (double& each : given.sample)
        each = static_cast<double>(support::draw(state));
    transformed = given;
    const hartley<Size> transform;
    transform.to_reversed(transformed.sample);
    for (std::size_t lane = 0; lane < width; ++lane) {
        long double squares = 0;
        for (std::size_t n = 0; n < Size; ++n)
            squares += static_cast<long double>(given.sample[n * width + lane]) *
                       static_cast<long double>(given.sample[n * width + lane]);
        // A rounding or two in each of log₂ N steps, of numbers as large as √N times the root mean square.
        const long double bound = 2 * std::log2(static_cast<long double>(Size)) * std::sqrt(squares) *
                                  std::numeric_limits<double>::epsilon();
        for (std::size_t k = 0; k < Size; ++k) {
            long double sum = 0;
            for (std::size_t n = 0; n < Size; ++n) {
                const long double angle =
                    2 * std::numbers::pi_v<long double> * static_cast<long double>(n * k % Size) / Size;
                sum += static_cast<long double>(given.sample[n * width + lane]) *
                       (std::cos(angle) + std::sin(angle));
            }
            const long double found =
                static_cast<long double>(transformed.sample[bits_reversed(k, Size) * width + lane]);
            CHECK(std::abs(found - sum) <= bound);
        }
    }
    transform.from_reversed(transformed.sample);
    for (std::size_t i = 0; i < Size * width; ++i)
        CHECK(transformed.sample[i] / static_cast<double>(Size) ==
              doctest::Approx(given.sample[i]).epsilon(1e-14));
}

TEST_CASE("hartley: the fast transform is the sum that defines it, and its own inverse") {
    compare<4>();
    compare<8>();
    compare<16>();
    compare<128>();
    compare<512>();
}

} // namespace
