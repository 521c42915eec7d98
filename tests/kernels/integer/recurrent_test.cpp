#include <tactnet/kernels/integer/recurrent.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

using namespace tactnet::kernels;

namespace {

constexpr std::size_t lanes = max_integer_lanes;

/// The largest magnitude of function(x) − exact(x ÷ 2048) · 32768, over all x that are sums of two sums.
template <class Function, class Exact>
double largest_error(const Function& function, const Exact& exact) {
    double largest = 0;
    for (std::int32_t first = -2 * cell_numbers::most; first <= 2 * cell_numbers::most;
         first += static_cast<std::int32_t>(lanes)) {
        int32_vec<lanes> x;
        for (std::size_t lane = 0; lane < lanes; ++lane)
            x[lane] = first + static_cast<std::int32_t>(lane);
        const int32_vec<lanes> found = function(x);
        for (std::size_t lane = 0; lane < lanes; ++lane)
            largest = std::max(largest, std::abs(found[lane] - exact(x[lane] / 2048.0) * 32768));
    }
    return largest;
}

} // namespace

TEST_CASE("recurrent: sigmoid and tanh of all sums are within their bounds") {
    CHECK(largest_error([](const int32_vec<lanes>& x) { return detail::sigmoid_of_sum<lanes>(x); },
                        [](double x) { return 1 / (1 + std::exp(-x)); }) < 1.9);
    CHECK(largest_error([](const int32_vec<lanes>& x) { return detail::tanh_of_sum<lanes>(x); },
                        [](double x) { return std::tanh(x); }) < 3.1);
    const auto all = [](std::int32_t x) { return x + int32_vec<lanes>{}; };
    CHECK(detail::tanh_of_sum<lanes>(all(0))[0] == 0);
    CHECK(detail::sigmoid_of_sum<lanes>(all(0))[0] == 16384);
    CHECK(detail::sigmoid_of_sum<lanes>(all(65534))[0] == 32768);
    CHECK(detail::sigmoid_of_sum<lanes>(all(-65534))[0] == 0);
    // So that states fit 16 bits, and their differences times a gate 32.
    CHECK(detail::tanh_of_sum<lanes>(all(65534))[0] == 32767);
    CHECK(detail::tanh_of_sum<lanes>(all(-65534))[0] == -32767);
}

TEST_CASE("recurrent: the largest products do not overflow") {
    const auto all = [](std::int32_t x) { return x + int32_vec<lanes>{}; };
    const auto first = [](const int32_vec<lanes>& x) { return x[0]; }; // Clang binds no reference to a lane
    for (const std::int32_t sign : {1, -1}) {
        // The update gate is open, and the state as far from its new value as it can be.
        std::array<int32_vec<lanes>, 1> state{all(-sign * 32767)};
        word_gru_cell::update<lanes>({all(32767), all(32767), all(sign * 32767)},
                                     {all(32767), all(32767), all(sign * 32767)}, state);
        CHECK(first(state[0]) == -sign * 32767);
        word_gru_cell::update<lanes>({all(32767), all(-32767), all(sign * 32767)},
                                     {all(32767), all(-32767), all(sign * 32767)}, state);
        CHECK(first(state[0]) == sign * 32767);
        // The content saturates.
        std::array<int32_vec<lanes>, 2> both{all(0), all(sign * 32767)};
        const std::array<int32_vec<lanes>, 4> sums{all(32767), all(32767), all(sign * 32767), all(32767)};
        word_lstm_cell::update<lanes>(sums, sums, both);
        CHECK(first(both[1]) == sign * 32767);
        CHECK(first(both[0]) == sign * 32767);
    }
}
