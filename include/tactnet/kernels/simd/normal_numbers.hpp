#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/runtime/random.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>

// Standard normal numbers by the hundreds: Philox in whole vectors, then the Box-Muller transform.
//
// The numbers are bit-identical with every instruction set, with and without fused multiply-adds. Therefore
// no rounded product is added to anything, since a compiler may fuse the two: logarithm and tangent are
// continued fractions (Abramowitz, Stegun, Handbook of Mathematical Functions, 4.1.39 with 4.6.33,
// and 4.3.94), whose steps are a division and a difference, which are rounded alike everywhere.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The normal numbers of a random stream, in chunks that can be computed independently.
class normal_numbers {
    static constexpr std::size_t blocks = 16; ///< counters at once: whole vectors of any instruction set
    static_assert(blocks % lanes<float> == 0);
    using words = std::array<std::uint32_t, blocks>;

public:
    static constexpr std::size_t chunk_size = 4 * blocks;

    explicit normal_numbers(const random_stream& random)
        : key_(random.key()), counter_(random.next_counter()) {}

    /// Writes the numbers index · chunk_size … of the stream to aligned memory. They are within ±6.7.
    void chunk(std::uint32_t index, float* to) const {
        alignas(vector_alignment) std::array<words, 4> random;
        philox_blocks(index * static_cast<std::uint32_t>(blocks), random);
        box_muller(random[0], random[1], to);
        box_muller(random[2], random[3], to + 2 * blocks);
    }
    /// Calls use(i, number) for the first `count` numbers of the stream.
    template <class Use>
    void each(std::size_t count, const Use& use) const {
        alignas(vector_alignment) std::array<float, chunk_size> numbers;
        for (std::size_t first = 0; first < count; first += chunk_size) {
            chunk(static_cast<std::uint32_t>(first / chunk_size), numbers.data());
            const std::size_t here = count - first < chunk_size ? count - first : chunk_size;
            for (std::size_t i = 0; i < here; ++i)
                use(first + i, numbers[i]);
        }
    }

private:
    /// Computes the words of philox() of runtime/random.hpp for consecutive counters. Plain loops, which
    /// compilers vectorise: xsimd has no such products.
    void philox_blocks(std::uint32_t first, std::array<words, 4>& x) const {
        for (std::size_t i = 0; i < blocks; ++i) {
            x[0][i] = counter_[0] + first + static_cast<std::uint32_t>(i);
            x[1][i] = counter_[1], x[2][i] = counter_[2], x[3][i] = counter_[3];
        }
        std::array<std::uint32_t, 2> key = key_;
        for (int round = 0; round < 10; ++round) {
            for (std::size_t i = 0; i < blocks; ++i) {
                const std::uint64_t a = std::uint64_t{0xD2511F53} * x[0][i],
                                    b = std::uint64_t{0xCD9E8D57} * x[2][i];
                x[0][i] = static_cast<std::uint32_t>(b >> 32) ^ x[1][i] ^ key[0];
                x[1][i] = static_cast<std::uint32_t>(b);
                x[2][i] = static_cast<std::uint32_t>(a >> 32) ^ x[3][i] ^ key[1];
                x[3][i] = static_cast<std::uint32_t>(a);
            }
            key[0] += 0x9E3779B9;
            key[1] += 0xBB67AE85;
        }
    }

    /// Writes radius · cosine of each block, then radius · sine.
    static void box_muller(const words& for_radius, const words& for_angle, float* to) {
        using v = vector<float>;
        // A uniform number in (0, 1] is 2^power · mantissa, with a mantissa in [√½, √2). The angle covers
        // half a turn; a negative radius gives the other half.
        alignas(vector_alignment) std::array<float, blocks> power, mantissa, quarter_angle, sign;
        constexpr std::uint32_t root_half = tactnet::detail::bits_as<std::uint32_t>(0x1.6a09e6p-1F);
        for (std::size_t i = 0; i < blocks; ++i) {
            const float uniform =
                (static_cast<float>(static_cast<std::int32_t>(for_radius[i] >> 1)) + 0.5F) * 0x1p-31F;
            const auto bits = tactnet::detail::bits_as<std::uint32_t>(uniform);
            const auto exponent = static_cast<std::int32_t>(bits - root_half) >> 23;
            power[i] = static_cast<float>(exponent);
            mantissa[i] =
                tactnet::detail::bits_as<float>(bits - (static_cast<std::uint32_t>(exponent) << 23));
            quarter_angle[i] = static_cast<float>(static_cast<std::int32_t>(for_angle[i] << 1)) *
                               static_cast<float>(std::numbers::pi / 4 * 0x1p-31);
            sign[i] = static_cast<std::int32_t>(for_angle[i]) < 0 ? -1.0F : 1.0F;
        }
        for (std::size_t i = 0; i < blocks; i += lanes<float>) {
            const v logarithm = load(power.data() + i) + log2_of(load(mantissa.data() + i));
            const v radius =
                square_root<float>(logarithm * v(-2 * std::numbers::ln2_v<float>)) * load(sign.data() + i);
            // The tangent of half the angle is t = x / d; cos = (1 − t²) / (1 + t²) and sin = 2 t / (1 + t²).
            const v x = load(quarter_angle.data() + i);
            const v d = tangent_denominator(x * x);
            const v t_squared = quotient<v>(x * x, d * d);
            const v scaled = quotient<v>(radius, v(1) + t_squared);
            store<float>(to + i, scaled * (v(1) - t_squared));
            store<float>(to + blocks + i, scaled * quotient<v>(v(2) * x, d));
        }
    }
    /// log₂ m = 2 atanh z / ln 2 with z = (m − 1) / (m + 1), with a relative error of 5·10⁻⁹ and rounding.
    static vector<float> log2_of(const vector<float>& m) {
        using v = vector<float>;
        const v z = quotient<v>(m - v(1), m + v(1));
        const v t = z * z;
        const v below = v(3) - quotient<v>(v(4) * t, v(5) - quotient<v>(v(9) * t, v(7)));
        return quotient<v>(v(2 / std::numbers::ln2_v<float>) * z, v(1) - quotient(t, below));
    }
    /// x / tan x for |x| ≤ π / 4, from x², with a relative error of 2·10⁻⁸ and rounding.
    static vector<float> tangent_denominator(const vector<float>& square) {
        using v = vector<float>;
        v below(9);
        for (const float odd : {7.0F, 5.0F, 3.0F, 1.0F})
            below = v(odd) - quotient(square, below);
        return below;
    }

    std::array<std::uint32_t, 2> key_;
    std::array<std::uint32_t, 4> counter_;
};

}}} // namespace tactnet::kernels
