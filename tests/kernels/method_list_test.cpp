#include <tactnet/kernels/method_list.hpp>

#include <doctest/doctest.h>

#include <string>
#include <type_traits>

using namespace tactnet::kernels;

namespace {

template <std::size_t Cost, char Letter = 'a'>
struct method {
    static constexpr char name[]{Letter, '\0'};
    static constexpr bool applicable = true;
    static constexpr std::size_t cost = Cost;
};
/// Its cost must not be read.
template <class Description>
struct inapplicable_method {
    static constexpr const char* name = "inapplicable";
    static constexpr bool applicable = false;
    static constexpr std::size_t cost = Description::missing;
};

} // namespace

TEST_CASE("method_list: chooses the cheapest applicable method, the first of equals") {
    CHECK(std::is_same_v<method_list<method<3>, method<2>, method<4>>::cheapest, method<2>>);
    CHECK(std::is_same_v<method_list<method<2, 'a'>, method<2, 'b'>>::cheapest, method<2, 'a'>>);
    CHECK(std::is_same_v<method_list<inapplicable_method<int>, method<5>>::cheapest, method<5>>);
    CHECK(std::is_same_v<method_list<method<5>, inapplicable_method<int>>::cheapest, method<5>>);
}

TEST_CASE("method_list: for_each_applicable visits methods in the order of the list") {
    std::string names;
    method_list<method<3, 'x'>, inapplicable_method<int>, method<1, 'y'>>::for_each_applicable(
        [&]<class Method>(std::type_identity<Method>) { names += Method::name; });
    CHECK(names == "xy");
}
