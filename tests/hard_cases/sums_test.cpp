// Ten million terms. Runs of 16 vectors are added in single precision, the runs in double: with A the sum of
// the terms' magnitudes that is off by γ(15) A for single precision and γ(10^7) A, 1e-9 A, for double.
// References are long doubles, whose own error is 1e-12 A.

#include "hold.hpp"

#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <support/tolerance.hpp>

using namespace tactnet;
using hard_cases::hold;
using hard_cases::unit;

namespace {

constexpr std::size_t terms = 10'000'000;
constexpr double u = support::unit_roundoff<float>;

template <class Term>
aligned_vector<float> filled(Term&& term) {
    aligned_vector<float> values(terms / kernels::lanes<float> * kernels::lanes<float>);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = term(i);
    return values;
}

void check_sum(const std::string& name, const aligned_vector<float>& values) {
    long double exact = 0, size = 0;
    for (const float v : values)
        exact += v, size += std::abs(v);
    const double ours =
        kernels::sum_terms<1, float>(values.size() / kernels::lanes<float>, [&](std::size_t i) {
            return std::array<kernels::vector<float>, 1>{
                kernels::load(values.data() + i * kernels::lanes<float>)};
        })[0];
    hold(name, unit::absolute,
         {static_cast<double>(exact), ours,
          (support::accumulated(u, 15) + 1.2e-9) * static_cast<double>(size)});
}

/// Mean and variance: differences from the first value are rounded once, D at most; then as above.
void check_moments(const std::string& name, const aligned_vector<float>& values) {
    long double sum = 0, squares = 0;
    for (const float v : values)
        sum += v;
    const auto count = static_cast<long double>(values.size());
    const long double mean = sum / count;
    double farthest = 0;
    for (const float v : values) {
        squares += (v - mean) * (v - mean);
        farthest = std::max(farthest, std::abs(static_cast<double>(v) - static_cast<double>(values[0])));
    }
    const kernels::moments ours =
        kernels::moments_of(values.data(), values.size() / kernels::lanes<float>, kernels::lanes<float>);
    hold(name + ", mean", unit::absolute,
         {static_cast<double>(mean), ours.mean,
          support::accumulated(u, 17) * farthest + 1e-15 * static_cast<double>(std::abs(mean))});
    hold(name + ", variance", unit::absolute,
         {static_cast<double>(squares / count), ours.variance(),
          support::accumulated(u, 2 * 19) * farthest * farthest});
}

} // namespace

TEST_CASE("sum_terms: ten million terms that cancel, grow, or hide behind one") {
    check_sum("10⁷ times 0.1", filled([](std::size_t) { return 0.1f; }));
    check_sum("10⁷ alternating, growing terms", filled([](std::size_t i) {
                  return (i % 2 ? -1.0f : 1.0f) * (1 + static_cast<float>(i) * 1e-4f);
              }));
    check_sum("10⁷ terms from 1e-20 to 1e20, growing",
              filled([](std::size_t i) { return std::pow(10.0f, static_cast<float>(i) / 2.5e5f - 20); }));
    check_sum("10⁷ ones after 1e12", filled([](std::size_t i) { return i == 0 ? 1e12f : 1.0f; }));
    check_sum("10⁷ thirds, 1e10 and −1e10 far apart", filled([](std::size_t i) {
                  return i == 5 ? 1e10f : i == 9'000'000 ? -1e10f : 1.0f / 3;
              }));
    check_sum("10⁷ denormals of 1e-42", filled([](std::size_t) { return 1e-42f; }));
}

TEST_CASE("moments_of: ten million values far from zero") {
    check_moments("10⁷ values of 1e6 ± 1", filled([](std::size_t i) {
                      return 1e6f + static_cast<float>(static_cast<int>(i * 37 % 101) - 50) / 50;
                  }));
    check_moments("10⁷ values of 1000, one of 1e6",
                  filled([](std::size_t i) { return i == 5'000'000 ? 1e6f : 1000.0f; }));
}
