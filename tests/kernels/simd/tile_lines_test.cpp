#include <tactnet/kernels/simd/tile_lines.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <type_traits>

using namespace tactnet;
using namespace tactnet::kernels;

// What the lines compute together is tested with tiles (batch/winograd/, frame/). Here that those of
// gradients are the others transposed: row i of one matrix is what its transpose makes of the unit
// vector i.

namespace {

/// Factors are rounded, and products of two of them: four roundings.
constexpr double four_roundings = 4 * 0x1p-53;

/// Lane 0 of a line of vectors of doubles.
template <std::size_t Size>
std::array<double, Size> first_lanes(const std::array<vector<double>, Size>& line) {
    std::array<double, Size> result{};
    for (std::size_t i = 0; i < Size; ++i) {
        alignas(64) std::array<double, lanes<double>> flat;
        store(flat.data(), line[i]);
        result[i] = flat[0];
    }
    return result;
}
template <std::size_t Size>
std::array<vector<double>, Size> unit_vector(std::size_t at) {
    std::array<vector<double>, Size> result;
    for (std::size_t i = 0; i < Size; ++i)
        result[i] = vector<double>(i == at ? 1.0 : 0.0);
    return result;
}

template <std::size_t N, std::size_t Kernel>
void check_transposed() {
    constexpr std::size_t outputs = N + 1 - Kernel;
    for (std::size_t i = 0; i < N; ++i) {
        const auto forward =
            first_lanes(kernels::detail::tile_output_line<outputs>(unit_vector<N>(i))); // column i of Aᵀ
        for (std::size_t o = 0; o < outputs; ++o) {
            const auto backward =
                first_lanes(kernels::detail::tile_gradient_line<N>(unit_vector<outputs>(o)));
            CHECK(std::abs(forward[o] - backward[i]) <= four_roundings * std::abs(forward[o]));
        }
        std::array<double, N> unit{};
        unit[i] = 1;
        const auto turned = kernels::detail::tile_weight_line<Kernel>(unit);
        for (std::size_t k = 0; k < Kernel; ++k) {
            std::array<double, Kernel> tap{};
            tap[k] = 1;
            CHECK(std::abs(kernels::detail::tile_kernel_line<N>(tap)[i] - turned[k]) <=
                  four_roundings * std::abs(turned[k]));
        }
    }
}

} // namespace

TEST_CASE("tile_lines: those of gradients are the transposed ones") {
    check_transposed<3, 2>();
    check_transposed<4, 2>();
    check_transposed<4, 3>();
    check_transposed<5, 2>();
    check_transposed<5, 3>();
    check_transposed<6, 2>();
    check_transposed<6, 3>();
}

TEST_CASE("tile_lines: a kernel in each lane is transformed as one alone") {
    const std::array<double, 3> kernel{0.1, -0.7, 1.3};
    std::array<vector<double>, 3> many;
    for (std::size_t i = 0; i < 3; ++i)
        many[i] = vector<double>(kernel[i]);
    const auto compare = [&]<std::size_t N>(std::integral_constant<std::size_t, N>) {
        const auto alone = kernels::detail::tile_kernel_line<N>(kernel);
        const auto together = first_lanes(kernels::detail::tile_kernel_line<N>(many));
        // Of at most six roundings that compilers may leave out where they fuse, of sums below 8.
        for (std::size_t i = 0; i < N; ++i)
            CHECK(std::abs(together[i] - alone[i]) <= 8 * 6 * 0x1p-53);
    };
    compare(std::integral_constant<std::size_t, 4>{});
    compare(std::integral_constant<std::size_t, 5>{});
    compare(std::integral_constant<std::size_t, 6>{});
}
