#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/integer/rounding.hpp>
#include <tactnet/kernels/local_response.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <ratio>

// Local response normalisation of bytes. The sum of squares S of the bytes less their zero is an exact
// integer. With the margin m = k ÷ (α/n · step²), the divisor (k + α/n · Σ x²)^β is k^β · ((S + m) ÷ m)^β.
// Roots, products and quotients are rounded one by one as IEEE 754 requires, and no product is added to
// anything: all instruction sets give the same bytes.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The exponents of a local response normalisation that square roots compute.
template <class Beta>
concept exponent_of_roots =
    std::ratio_equal_v<Beta, std::ratio<1, 2>> || std::ratio_equal_v<Beta, std::ratio<3, 4>> ||
    std::ratio_equal_v<Beta, std::ratio<1>>;

/// The numbers with which responses in bytes are normalised.
struct byte_response_constants {
    float margin;         ///< m
    float ratio;          ///< steps of the output in a step of the input
    std::int32_t zero;    ///< of the input
    std::int32_t to_zero; ///< of the output
};

/// Normalises the channels of each pixel, `Stride` elements from one pixel to the next in both maps.
template <class Rule, std::size_t Channels, std::size_t Stride>
void normalise_byte_responses(std::size_t pixels, const byte_response_constants& constants,
                              const std::uint8_t* in, std::uint8_t* out) noexcept {
    static_assert(Rule::size * 255 * 255 <= 1 << 24); // single precision holds such sums of squares
    constexpr std::size_t width = std::min(widest_bytes(Stride), max_integer_lanes),
                          room = padded_size<float>(Stride);
    const auto power = [](float x) {
        alignas(vector_alignment) std::array<float, lanes<float>> all;
        store(all.data(), Rule::template power<float>(vector<float>(x)));
        return all[0];
    };
    const float factor = constants.ratio * (power(static_cast<float>(Rule::k)) / power(constants.margin));
    const byte_range range{0, 255, constants.to_zero};
    std::array<std::int32_t, Stride + Rule::size> squares{};
    alignas(vector_alignment) std::array<float, room> powers;
    powers.fill(1);
    for (std::size_t p = 0; p < pixels; ++p, in += Stride, out += Stride) {
        for (std::size_t c = 0; c < Channels; ++c) {
            const std::int32_t distance = in[c] - constants.zero;
            squares[Rule::before + c] = distance * distance;
        }
        for (std::size_t c = 0; c < Stride; c += width) {
            int32_vec<width> sum{};
            for (std::size_t i = 0; i < Rule::size; ++i)
                sum += load_bytes_as<int32_vec<width>>(squares.data() + c + i);
            store_any(powers.data() + c, __builtin_convertvector(sum, float_vec<width>) + constants.margin);
        }
        for (std::size_t c = 0; c < room; c += lanes<float>)
            store(powers.data() + c, Rule::template power<float>(load(powers.data() + c)));
        for (std::size_t c = 0; c < Stride; c += width) {
            const int32_vec<width> distances =
                instructions::to_int32<width>(load_bytes_as<uint8_vec<width>>(in + c)) - constants.zero;
            const float_vec<width> factors = load_bytes_as<float_vec<width>>(powers.data() + c) * factor;
            store_rounded<width>(out + c, distances, factors, range);
        }
    }
}

}}} // namespace tactnet::kernels
