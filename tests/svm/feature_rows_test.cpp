#include "samples.hpp"

#include <tactnet/svm/feature_rows.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <vector>

using namespace tactnet;

TEST_CASE("standardisation: mean nought and deviation one; constant features are only centred") {
    support::samples s = support::blobs(1000, 3, 2, 2);
    for (std::size_t i = 0; i < 1000; ++i) {
        s.values[3 * i + 1] = 0.1F;
        s.values[3 * i + 2] = 1e15F * s.values[3 * i + 2] + 3e15F;
    }
    const standardisation fitted = standardisation::of(s.rows());
    CHECK(fitted.deviation[1] == 1);
    const std::vector<float> standard = fitted.apply(s.rows());
    for (std::size_t f = 0; f < 3; ++f) {
        double mean = 0, squares = 0;
        for (std::size_t i = 0; i < 1000; ++i)
            mean += static_cast<double>(standard[3 * i + f]) / 1000;
        for (std::size_t i = 0; i < 1000; ++i)
            squares += std::pow(static_cast<double>(standard[3 * i + f]) - mean, 2) / 1000;
        CHECK(std::abs(mean) < 1e-6);
        CHECK(squares == doctest::Approx(f == 1 ? 0 : 1).epsilon(1e-5));
    }
    CHECK_THROWS_AS((void)fitted.apply({s.values, 5}), std::invalid_argument);
    CHECK_THROWS_AS((void)standardisation::of({{}, 3}), std::invalid_argument);
}
