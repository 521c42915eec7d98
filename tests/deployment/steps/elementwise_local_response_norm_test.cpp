#include <tactnet/deployment/steps/elementwise.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <ratio>

using namespace tactnet;

namespace {

constexpr shape map{2, 2, 8};

template <class Rule>
double reach_of(double input) {
    return local_response_norm_step<single_precision, map, 8, Rule>::output_bound(nullptr, input);
}

} // namespace

TEST_CASE("local_response_norm_step::output_bound: the largest of x, of x by the smallest divisor, and of "
          "the squares") {
    using usual = kernels::response_rule<5, std::ratio<1, 10000>, std::ratio<3, 4>, std::ratio<2>>;
    CHECK(reach_of<usual>(0.1) == doctest::Approx(0.1));   // squares are small, and 2^-3/4 is below one
    CHECK(reach_of<usual>(3) == doctest::Approx(5 * 9.0)); // squares
    using amplifying = kernels::response_rule<5, std::ratio<1, 10000>, std::ratio<3, 4>, std::ratio<1, 16>>;
    CHECK(reach_of<amplifying>(0.5) == doctest::Approx(0.5 * std::pow(1.0 / 16, -0.75)));
}
