#include <tactnet/kernels/rows/squared_distance.hpp>

#include <doctest/doctest.h>

#include <support/whole_numbers.hpp>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

template <std::size_t Length>
void compare() {
    const auto a = support::whole_numbers<float>(Length, 7919),
               b = support::whole_numbers<float>(Length, 104729);
    float expected = 0;
    for (std::size_t i = 0; i < Length; ++i)
        expected += (a[i] - b[i]) * (a[i] - b[i]);
    CHECK(squared_distance<Length>(a.data(), b.data()) == expected);
    CHECK(squared_distance<Length>(a.data(), a.data()) == 0);
}

} // namespace

TEST_CASE("squared_distance: against plain loops") {
    compare<lanes<float>>();
    compare<64>();
    compare<5 * lanes<float>>();
}
