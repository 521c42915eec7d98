#include <tactnet/kernels/simd/normal_numbers.hpp>
#include <tactnet/kernels/simd/tile_lines.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <type_traits>
#include <vector>

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

constexpr std::size_t group = normal_numbers::chunk_size;
constexpr random_purpose purpose{8};

std::vector<double> drawn(const random_stream& random, std::size_t count) {
    std::vector<double> numbers(count);
    normal_numbers(random).each(
        count, [&](std::size_t i, float number) { numbers[i] = static_cast<double>(number); });
    return numbers;
}

} // namespace

// Statistics: n draws, five standard deviations.

TEST_CASE("normal_numbers: moments and tails") {
    constexpr std::size_t count = 2'000'000;
    constexpr double n = count;
    const std::vector<double> numbers = drawn(random_stream(3, purpose), count);
    double moments[5] = {};
    for (const double x : numbers) {
        double power = 1;
        for (int k = 1; k <= 4; ++k)
            moments[k] += (power *= x) / n;
    }
    CHECK(std::abs(moments[1]) < 5 * std::sqrt(1 / n));
    CHECK(std::abs(moments[2] - 1) < 5 * std::sqrt(2 / n));
    CHECK(std::abs(moments[3]) < 5 * std::sqrt(15 / n));
    CHECK(std::abs(moments[4] - 3) < 5 * std::sqrt(96 / n));
    for (const double limit : {-4.0, -3.0, -2.0, -1.0, -0.1, 0.0, 0.1, 1.0, 2.0, 3.0, 4.0}) {
        CAPTURE(limit);
        const double share = std::erfc(-limit / std::numbers::sqrt2) / 2;
        const auto below = std::count_if(numbers.begin(), numbers.end(), [&](double x) { return x < limit; });
        CHECK(std::abs(static_cast<double>(below) - n * share) < 5 * std::sqrt(n * share * (1 - share)));
    }
}
TEST_CASE("normal_numbers: independent of each other, near and far") {
    constexpr std::size_t count = 1'000'000;
    const std::vector<double> numbers = drawn(random_stream(4, purpose), count);
    // 16 and 32 apart are the two numbers of one transform, and the two transforms of one block.
    for (const std::size_t apart : {1u, 2u, 15u, 16u, 17u, 32u, 48u, 64u, 50u, 1400u}) {
        CAPTURE(apart);
        double product = 0, squares = 0;
        for (std::size_t i = 0; i + apart < count; ++i) {
            product += numbers[i] * numbers[i + apart];
            squares += (numbers[i] * numbers[i] - 1) * (numbers[i + apart] * numbers[i + apart] - 1);
        }
        CHECK(std::abs(product) < 5 * std::sqrt(static_cast<double>(count)));
        CHECK(std::abs(squares) < 5 * std::sqrt(4.0 * static_cast<double>(count)));
    }
}
TEST_CASE("normal_numbers: Box and Muller's transform of the stream's own words") {
    const std::uint64_t seed = 0x123456789abcdef;
    std::array<float, group> numbers;
    for (const std::uint32_t index : {0u, 1u, 1000u}) {
        alignas(64) std::array<float, group> aligned;
        normal_numbers(random_stream(seed, purpose, 5, 6)).chunk(index, aligned.data());
        numbers = aligned;
        for (std::uint32_t block = 0; block < 16; ++block) {
            const auto words = philox({16 * index + block, purpose.number(), 5, 6}, {0x89abcdef, 0x01234567});
            for (std::size_t pair = 0; pair < 2; ++pair) {
                const double uniform = (static_cast<double>(words[2 * pair] >> 1) + 0.5) * 0x1p-31;
                const double angle =
                    static_cast<double>(static_cast<std::int32_t>(words[2 * pair + 1] << 1)) * 0x1p-31 *
                    std::numbers::pi / 2;
                const double radius =
                    (words[2 * pair + 1] >> 31 ? -1 : 1) * std::sqrt(-2 * std::log(uniform));
                // Fifteen roundings at most, each of half a unit of float, of numbers no larger than the
                // radius; and of the uniform number, whose logarithm loses digits where it is near 1.
                const double allowed =
                    15 * 0x1p-24 * std::abs(radius) + 0x1p-24 / std::max(std::abs(radius), 1e-4);
                const double x = static_cast<double>(numbers[32 * pair + block]),
                             y = static_cast<double>(numbers[32 * pair + 16 + block]);
                CHECK(std::abs(x - radius * std::cos(angle)) <= allowed);
                CHECK(std::abs(y - radius * std::sin(angle)) <= allowed);
            }
        }
    }
}
TEST_CASE("normal_numbers: the same bits with every instruction set") {
    std::uint64_t hash = 0xcbf29ce484222325; // Fowler, Noll and Vo's
    for (std::uint32_t index = 0; index < 1000; ++index) {
        alignas(64) std::array<float, group> numbers;
        normal_numbers(random_stream(7, purpose, 3, 2)).chunk(index, numbers.data());
        for (const float number : numbers)
            hash = (hash ^ std::bit_cast<std::uint32_t>(number)) * 0x100000001b3;
    }
    CHECK(hash == 2021058600233274009u);
}

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
