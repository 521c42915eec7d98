#pragma once

#include <tactnet/simulation/effect.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace tactnet::inline TACTNET_ARCH {
namespace simulation {

/// Counts go through a grey JPEG file (ITU-T T.81), which leaves faint counts around every imprint: each
/// block of 8 × 8 is transformed by cosines, its coefficients are rounded to multiples of the standard's
/// table for luminance (K.1), scaled by the quality as libjpeg does. Blocks that reach beyond the image are
/// filled up with its last row and column. The paper's images are files of quality 75.
struct jpeg_storage {
    static constexpr stage place = stage::storage;

    int quality = 75; ///< 1 to 100; 0 for no file at all

    template <shape Shape>
    class bound {
    public:
        bound(const jpeg_storage& effect, const mounting&) : stored_(effect.quality > 0) {
            const int quality = std::clamp(effect.quality, 1, 100);
            const int scale = quality < 50 ? 5000 / quality : 200 - 2 * quality;
            for (std::size_t i = 0; i < 64; ++i)
                steps_[i / 8][i % 8] =
                    static_cast<float>(std::clamp((luminance[i] * scale + 50) / 100, 1, 255));
        }
        void apply(signal<Shape> counts, const moment&) const noexcept {
            if (!stored_)
                return;
            for (std::size_t row = 0; row < Shape.rows; row += 8)
                for (std::size_t column = 0; column < Shape.columns; column += 8)
                    store(counts, row, column);
        }

    private:
        using block = std::array<std::array<float, 8>, 8>;

        void store(signal<Shape> counts, std::size_t top, std::size_t left) const {
            block values;
            for (std::size_t y = 0; y < 8; ++y)
                for (std::size_t x = 0; x < 8; ++x)
                    values[y][x] =
                        counts(std::min(top + y, Shape.rows - 1), std::min(left + x, Shape.columns - 1)) -
                        128;
            block coefficients = product(product(cosines, values), transposed);
            for (std::size_t v = 0; v < 8; ++v)
                for (std::size_t u = 0; u < 8; ++u)
                    coefficients[v][u] = std::nearbyint(coefficients[v][u] / steps_[v][u]) * steps_[v][u];
            values = product(product(transposed, coefficients), cosines);
            for (std::size_t y = 0; y < std::min<std::size_t>(8, Shape.rows - top); ++y)
                for (std::size_t x = 0; x < std::min<std::size_t>(8, Shape.columns - left); ++x)
                    counts(top + y, left + x) = std::clamp(std::nearbyint(values[y][x] + 128), 0.0f, 255.0f);
        }
        static block product(const block& a, const block& b) {
            block result{};
            for (std::size_t y = 0; y < 8; ++y)
                for (std::size_t k = 0; k < 8; ++k)
                    for (std::size_t x = 0; x < 8; ++x)
                        result[y][x] += a[y][k] * b[k][x];
            return result;
        }

        static block basis(bool turned) {
            block result;
            for (std::size_t k = 0; k < 8; ++k)
                for (std::size_t n = 0; n < 8; ++n) {
                    const double value = (k == 0 ? std::sqrt(0.125) : 0.5) *
                                         std::cos((2 * static_cast<double>(n) + 1) * static_cast<double>(k) *
                                                  std::numbers::pi / 16);
                    (turned ? result[n][k] : result[k][n]) = static_cast<float>(value);
                }
            return result;
        }
        static constexpr std::array<int, 64> luminance{
            16, 11, 10, 16, 24,  40,  51,  61,  12, 12, 14, 19, 26,  58,  60,  55, //
            14, 13, 16, 24, 40,  57,  69,  56,  14, 17, 22, 29, 51,  87,  80,  62, //
            18, 22, 37, 56, 68,  109, 103, 77,  24, 35, 55, 64, 81,  104, 113, 92, //
            49, 64, 78, 87, 103, 121, 120, 101, 72, 92, 95, 98, 112, 100, 103, 99};

        bool stored_;
        block steps_;
        block cosines = basis(false), transposed = basis(true);
    };
};

} // namespace simulation
} // namespace tactnet
