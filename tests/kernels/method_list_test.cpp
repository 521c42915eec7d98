#include <tactnet/kernels/method_list.hpp>

#include <doctest/doctest.h>

#include <cstddef>
#include <type_traits>

using namespace tactnet;

namespace {

template <std::size_t Cost>
struct method {
    static constexpr bool applicable = true;
    static constexpr std::size_t cost = Cost;
};
template <class T>
struct inapplicable {
    static constexpr bool applicable = false;
    static constexpr std::size_t cost = T::does_not_exist;
};

template <class... Methods>
using cheapest = typename kernels::method_list<Methods...>::cheapest;

} // namespace

TEST_CASE("method_list: takes the applicable method of least cost, and the first of equals") {
    static_assert(std::is_same_v<cheapest<method<3>>, method<3>>);
    static_assert(std::is_same_v<cheapest<method<3>, method<1>, method<2>>, method<1>>);
    static_assert(std::is_same_v<cheapest<inapplicable<int>, method<9>>, method<9>>);
    struct second : method<4> {};
    static_assert(std::is_same_v<cheapest<method<4>, second>, method<4>>);
    static_assert(std::is_same_v<cheapest<second, method<4>>, second>);
    CHECK(cheapest<method<7>, method<5>>::cost == 5);
}
