#pragma once

#include <tactnet/image/resize.hpp>
#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH { namespace simulation {

/// Resizes counts as the paper makes its smaller images: bicubic, then rounded. The same size changes
/// nothing.
template <std::size_t Rows, std::size_t Columns, class Kernel = keys_cubic<>>
struct resolution {
    static_assert(Rows > 0 && Columns > 0, "resolution: there must be at least one row and one column");
    static constexpr stage place = stage::storage;
    template <shape In>
    static constexpr shape output{Rows, Columns, In.channels};

    double last = 255; ///< the largest count

    template <shape Shape>
    class bound {
    public:
        static constexpr shape resized = output<Shape>;

        bound(const resolution& effect, const mounting&)
            : last_(static_cast<float>(effect.last > 0 ? effect.last : 0)) {}
        void apply(tensor_view<const float, Shape> from, signal<resized> to, const moment&) const noexcept {
            resize<Shape, resized, Kernel>(from, to);
            for (float& count : to.elements()) {
                const float kept = count > 0 ? (count < last_ ? count : last_) : 0;
                count = std::floor(kept + 0.5f);
            }
        }
        void apply(signal<Shape>, const moment&) const noexcept
            requires(Shape == resized)
        {}

    private:
        float last_;
    };
};

// JPEG compression of 8 × 8 pixels: the cosine transform, quantisation, and their inverses. In the integer
// arithmetic of Loeffler, Ligtenberg and Moschytz ("Practical fast 1-D DCT algorithms with 11
// multiplications", 1989) with constants of 13 bits and two more bits between the passes, as libjpeg's
// default, to which it is bit-identical.

/// A block, row by row, or the divisors of its frequencies.
using jpeg_block = std::array<std::int32_t, 64>;

/// The divisors of luminance in the example of the standard (ITU-T T.81, table K.1), scaled to a quality of 1
/// … 100 as in libjpeg; other qualities are clamped.
[[nodiscard]] constexpr jpeg_block jpeg_divisors(int quality) {
    jpeg_block divisors{16, 11, 10, 16, 24,  40,  51,  61,  12, 12, 14, 19, 26,  58,  60,  55,
                        14, 13, 16, 24, 40,  57,  69,  56,  14, 17, 22, 29, 51,  87,  80,  62,
                        18, 22, 37, 56, 68,  109, 103, 77,  24, 35, 55, 64, 81,  104, 113, 92,
                        49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99};
    const int kept = std::clamp(quality, 1, 100);
    const int percent = kept < 50 ? 5000 / kept : 200 - 2 * kept;
    for (std::int32_t& divisor : divisors)
        divisor = std::clamp((divisor * percent + 50) / 100, 1, 255);
    return divisors;
}

namespace detail {

inline constexpr int jpeg_constant_bits = 13, jpeg_pass_bits = 2;

[[nodiscard]] constexpr std::int32_t jpeg_constant(double value) {
    return static_cast<std::int32_t>(value * (1 << jpeg_constant_bits) + 0.5);
}
/// value / 2^bits, rounded, halves upwards.
[[nodiscard]] constexpr std::int32_t rounded_shift(std::int32_t value, int bits) {
    return (value + (1 << (bits - 1))) >> bits;
}

/// The rotation of the even frequencies 2 and 6, forward and inverse.
struct jpeg_even {
    std::int32_t two, six;

    constexpr jpeg_even(std::int32_t a, std::int32_t b) {
        const std::int32_t both = (a + b) * jpeg_constant(0.541196100);
        two = both + b * jpeg_constant(0.765366865);
        six = both - a * jpeg_constant(1.847759065);
    }
};
/// The odd frequencies 7, 5, 3 and 1, forward and inverse.
struct jpeg_odd {
    std::int32_t seven, five, three, one;

    constexpr jpeg_odd(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
        const std::int32_t all = (a + b + c + d) * jpeg_constant(1.175875602);
        const std::int32_t ad = -(a + d) * jpeg_constant(0.899976223),
                           bc = -(b + c) * jpeg_constant(2.562915447),
                           ac = all - (a + c) * jpeg_constant(1.961570560),
                           bd = all - (b + d) * jpeg_constant(0.390180644);
        seven = a * jpeg_constant(0.298631336) + ad + ac;
        five = b * jpeg_constant(2.053119869) + bc + bd;
        three = c * jpeg_constant(3.072711026) + bc + ac;
        one = d * jpeg_constant(1.501321110) + ad + bd;
    }
};

/// Transforms eight pixels, Stride apart, to frequencies times √8, with two more bits between the passes.
template <std::size_t Stride, bool First>
constexpr void jpeg_forward(std::int32_t* x) {
    const auto at = [x](std::size_t i) -> std::int32_t& { return x[i * Stride]; };
    constexpr int shift = jpeg_constant_bits + (First ? -jpeg_pass_bits : jpeg_pass_bits);
    const std::int32_t outer = at(0) + at(7) + at(3) + at(4), inner = at(1) + at(6) + at(2) + at(5);
    const jpeg_even even(at(1) + at(6) - at(2) - at(5), at(0) + at(7) - at(3) - at(4));
    const jpeg_odd odd(at(3) - at(4), at(2) - at(5), at(1) - at(6), at(0) - at(7));
    if constexpr (First) {
        at(0) = (outer + inner) * (1 << jpeg_pass_bits);
        at(4) = (outer - inner) * (1 << jpeg_pass_bits);
    } else {
        at(0) = rounded_shift(outer + inner, jpeg_pass_bits);
        at(4) = rounded_shift(outer - inner, jpeg_pass_bits);
    }
    at(2) = rounded_shift(even.two, shift), at(6) = rounded_shift(even.six, shift);
    at(1) = rounded_shift(odd.one, shift), at(3) = rounded_shift(odd.three, shift);
    at(5) = rounded_shift(odd.five, shift), at(7) = rounded_shift(odd.seven, shift);
}

/// The inverse. The second pass removes the scale of both passes and the factor 8.
template <std::size_t Stride, bool First>
constexpr void jpeg_inverse(std::int32_t* x) {
    const auto at = [x](std::size_t i) -> std::int32_t& { return x[i * Stride]; };
    constexpr int shift = jpeg_constant_bits + (First ? -jpeg_pass_bits : jpeg_pass_bits + 3);
    const jpeg_even even(at(6), at(2));
    const jpeg_odd odd(at(7), at(5), at(3), at(1));
    const std::int32_t sum = (at(0) + at(4)) * (1 << jpeg_constant_bits),
                       difference = (at(0) - at(4)) * (1 << jpeg_constant_bits);
    const std::array<std::int32_t, 4> evens{sum + even.two, difference + even.six, difference - even.six,
                                            sum - even.two};
    const std::array<std::int32_t, 4> odds{odd.one, odd.three, odd.five, odd.seven};
    for (std::size_t i = 0; i < 4; ++i) {
        at(i) = rounded_shift(evens[i] + odds[i], shift);
        at(7 - i) = rounded_shift(evens[i] - odds[i], shift);
    }
}

} // namespace detail

/// Compresses and decompresses a block of counts 0 … 255.
constexpr void jpeg_write_and_read(jpeg_block& block, const jpeg_block& divisors) {
    constexpr std::int32_t middle = 128;
    for (std::int32_t& count : block)
        count -= middle;
    for (std::size_t row = 0; row < 8; ++row)
        detail::jpeg_forward<1, true>(block.data() + 8 * row);
    for (std::size_t column = 0; column < 8; ++column)
        detail::jpeg_forward<8, false>(block.data() + column);
    for (std::size_t i = 0; i < block.size(); ++i) {
        // The divisor includes the factor 8 of the transform. Rounds halves away from zero.
        const std::int32_t divisor = 8 * divisors[i], size = block[i] < 0 ? -block[i] : block[i];
        const std::int32_t level = (size + divisor / 2) / divisor;
        block[i] = (block[i] < 0 ? -level : level) * divisors[i];
    }
    for (std::size_t column = 0; column < 8; ++column)
        detail::jpeg_inverse<8, true>(block.data() + column);
    for (std::size_t row = 0; row < 8; ++row)
        detail::jpeg_inverse<1, false>(block.data() + 8 * row);
    for (std::int32_t& count : block)
        count = std::clamp(count + middle, 0, 255);
}

/// Compresses counts as a grey JPEG file does, in which the paper's images are stored: small counts appear
/// around each imprint, and edges blur. Values are rounded and clamped to 0 … 255; NaN becomes 0.
struct jpeg_storage {
    static constexpr stage place = stage::storage;

    int quality = 75; ///< of libjpeg, 1 … 100, by default that of the paper's files; 0 or less is lossless

    template <shape Shape>
    class bound {
        static_assert(Shape.channels == 1, "jpeg_storage: there is one grey channel");

    public:
        bound(const jpeg_storage& effect, const mounting&)
            : lossless_(effect.quality <= 0), divisors_(jpeg_divisors(effect.quality)) {
            jpeg_write_and_read(blank_, divisors_);
        }
        void apply(signal<Shape> counts, const moment&) const noexcept {
            if (lossless_)
                return;
            for (std::size_t row = 0; row < Shape.rows; row += side)
                for (std::size_t column = 0; column < Shape.columns; column += side)
                    store_block(counts, row, column);
        }

    private:
        static constexpr std::size_t side = 8;

        /// Blocks beyond the image repeat the last row and column, as in libjpeg.
        void store_block(signal<Shape> counts, std::size_t first_row, std::size_t first_column) const {
            jpeg_block block;
            bool blank = true;
            for (std::size_t y = 0; y < side; ++y)
                for (std::size_t x = 0; x < side; ++x) {
                    const float count = counts(std::min(first_row + y, Shape.rows - 1),
                                               std::min(first_column + x, Shape.columns - 1));
                    const float kept = count > 0 ? (count < 255 ? count : 255) : 0;
                    block[y * side + x] = static_cast<std::int32_t>(kept + 0.5f);
                    blank = blank && block[y * side + x] == 0;
                }
            if (blank) // as most are
                block = blank_;
            else
                jpeg_write_and_read(block, divisors_);
            for (std::size_t y = 0; y < std::min(side, Shape.rows - first_row); ++y)
                for (std::size_t x = 0; x < std::min(side, Shape.columns - first_column); ++x)
                    counts(first_row + y, first_column + x) = static_cast<float>(block[y * side + x]);
        }

        bool lossless_;
        jpeg_block divisors_;
        jpeg_block blank_{}; // a compressed block of zeros, not quite zero at the lowest qualities
    };
};

}}} // namespace tactnet::simulation
