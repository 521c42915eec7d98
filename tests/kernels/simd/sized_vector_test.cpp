#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <cstddef>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

/// Numbers whose sum depends on the order: one so large that those after it are lost in it one by one, but
/// not together.
template <std::size_t Lanes>
void check_order() {
    aligned_vector<float> values(Lanes);
    for (std::size_t i = 0; i < Lanes; ++i)
        values[i] = i == 0 ? 0x1p24F : 1.0F;
    float in_float = 0;
    double in_double = 3;
    for (const float value : values) {
        in_float += value;
        in_double += static_cast<double>(value);
    }
    const auto whole = load_as<sized_vector<float, Lanes>>(values.data());
    CHECK(add_lanes<float, Lanes>(whole) == in_float);
    CHECK(add_lanes<float, Lanes>(whole, 3.0) == in_double);
}

} // namespace

TEST_CASE("add_lanes: one after the other") {
    check_order<min_lanes<float>>();
    check_order<lanes<float>>();
}

TEST_CASE("add_each_lane: to totals in double") {
    aligned_vector<float> values(lanes<float>);
    aligned_vector<double> totals(lanes<float> + 1, 1e9);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = static_cast<float>(i) + 0.125F;
    add_each_lane<float>(totals.data(), load(values.data()));
    for (std::size_t i = 0; i < values.size(); ++i)
        CHECK(totals[i] == 1e9 + static_cast<double>(values[i]));
    CHECK(totals.back() == 1e9);
}
