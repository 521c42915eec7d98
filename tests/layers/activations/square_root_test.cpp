#include <tactnet/layers/activations/square_root.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <limits>
#include <support/layers/conformance.hpp>
#include <utility>

using namespace tactnet;
using support::check_layer;

TEST_CASE("square_root: positive and negative inputs") {
    check_layer<square_root<>, shape{2, 3, 5}>();
}
TEST_CASE("square_root: another offset, counts as they are") {
    check_layer<square_root<std::ratio<3, 8>>, shape{3, 7, 2}>({.low = 1, .high = 255});
}

// √(x + o) − √o would lose all digits of x where it is far smaller than o.
TEST_CASE("square_root: small inputs keep their digits, zero stays zero, NaN stays NaN") {
    constexpr std::size_t count = 64; // whole vectors of any instruction set
    alignas(vector_alignment) std::array<float, count> in{}, out{};
    in[1] = 1e-12F, in[2] = -1.0F, in[3] = std::numeric_limits<float>::quiet_NaN(), in[4] = -0.0F;
    constexpr float offset = 0.25F;
    kernels::transform_vectors(kernels::shifted_root(offset), count, out.data(), std::as_const(in).data());
    CHECK(out[0] == 0);
    // Two roots, a sum and a quotient, each rounded once, and the sum with the offset: five roundings.
    CHECK(std::abs(static_cast<double>(out[1]) - 1e-12) <= 6 * 0x1p-24 * 1e-12);
    CHECK(out[2] == 0);
    CHECK(std::isnan(out[3]));
    CHECK(out[4] == 0);
}
