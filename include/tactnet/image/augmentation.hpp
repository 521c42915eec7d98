#pragma once

#include <tactnet/kernels/random.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <span>

namespace tactnet::inline TACTNET_ARCH {

/// What may happen to a pressure image before it is shown to a network: the same object, touched elsewhere,
/// in another direction, or harder.
struct augmentation_ranges {
    double reflect_rows = 0;    ///< probability of turning upside down
    double reflect_columns = 0; ///< probability of exchanging left and right
    double translation = 0;     ///< tactels, uniform in ± in both directions
    double rotation = 0;        ///< degrees about the centre, uniform in ±
    double scale = 0;           ///< size, log-uniform in 1 / (1 + scale) … 1 + scale
    double pressure = 0;        ///< all counts, log-uniform in 1 / (1 + pressure) … 1 + pressure

    /// The paper's: reflections with probability ½; ± 3 tactels and ± 10° at 28 × 50, ± 2 and ± 3° at 20 × 35
    /// and 14 × 25, ± 1 and ± 2° at 10 × 18 and 7 × 13.
    [[nodiscard]] static constexpr augmentation_ranges published(std::size_t rows, std::size_t columns) {
        augmentation_ranges r{.reflect_rows = 0.5, .reflect_columns = 0.5, .translation = 3, .rotation = 10};
        if (rows <= 10 && columns <= 18)
            r.translation = 1, r.rotation = 2;
        else if (rows <= 20 && columns <= 35)
            r.translation = 2, r.rotation = 3;
        return r;
    }
    friend constexpr bool operator==(const augmentation_ranges&, const augmentation_ranges&) = default;
};

/// An affine map from output to input coordinates, both counted from the image's centre, and a factor for the
/// counts.
struct image_transform {
    double row_by_row = 1, row_by_column = 0, row_shift = 0;
    double column_by_row = 0, column_by_column = 1, column_shift = 0;
    double gain = 1;

    [[nodiscard]] static image_transform draw(const augmentation_ranges& ranges, random_stream& random) {
        const double angle = random.uniform(-1, 1) * ranges.rotation * std::numbers::pi / 180;
        const double zoom = std::pow(1 + ranges.scale, random.uniform(-1, 1));
        const double row_shift = random.uniform(-1, 1) * ranges.translation;
        const double column_shift = random.uniform(-1, 1) * ranges.translation;
        const double row_sign = random.uniform() < ranges.reflect_rows ? -1 : 1;
        const double column_sign = random.uniform() < ranges.reflect_columns ? -1 : 1;
        const double gain = std::pow(1 + ranges.pressure, random.uniform(-1, 1));

        // Reflect, zoom and rotate, then shift; inverted, since each output asks where it comes from.
        const double c = std::cos(angle) / zoom, s = std::sin(angle) / zoom;
        image_transform t{.row_by_row = row_sign * c,
                          .row_by_column = row_sign * s,
                          .column_by_row = -column_sign * s,
                          .column_by_column = column_sign * c,
                          .gain = gain};
        t.row_shift = -(t.row_by_row * row_shift + t.row_by_column * column_shift);
        t.column_shift = -(t.column_by_row * row_shift + t.column_by_column * column_shift);
        return t;
    }
};

/// Bilinear interpolation, zeros outside. Channels are transformed alike.
template <shape Shape>
void transform_image(const image_transform& t, std::span<const std::uint8_t, Shape.size()> from,
                     tensor_view<float, Shape> to) {
    constexpr std::size_t border = 2, stride = Shape.columns + 2 * border;
    constexpr auto rows = static_cast<float>(Shape.rows), columns = static_cast<float>(Shape.columns);
    std::array<float, (Shape.rows + 2 * border) * stride> padded{}; // so that no tap needs to ask where it is
    for (std::size_t channel = 0; channel < Shape.channels; ++channel) {
        for (std::size_t y = 0; y < Shape.rows; ++y)
            for (std::size_t x = 0; x < Shape.columns; ++x)
                padded[(y + border) * stride + x + border] =
                    static_cast<float>(from[channel * Shape.area() + y * Shape.columns + x] * t.gain);
        const double center_row = (static_cast<double>(Shape.rows) - 1) / 2,
                     center_column = (static_cast<double>(Shape.columns) - 1) / 2;
        for (std::size_t y = 0; y < Shape.rows; ++y) {
            const double v = static_cast<double>(y) - center_row;
            const double row_start =
                t.row_by_row * v + t.row_shift + center_row - t.row_by_column * center_column;
            const double column_start =
                t.column_by_row * v + t.column_shift + center_column - t.column_by_column * center_column;
            for (std::size_t x = 0; x < Shape.columns; ++x) {
                const double u = static_cast<double>(x);
                const float row =
                    std::clamp(static_cast<float>(row_start + t.row_by_column * u), -1.0f, rows);
                const float column =
                    std::clamp(static_cast<float>(column_start + t.column_by_column * u), -1.0f, columns);
                const int top = static_cast<int>(row + 1) + 1,
                          left = static_cast<int>(column + 1) + 1; // ≥ 0: truncation is floor
                const float down = row + 2 - static_cast<float>(top),
                            right = column + 2 - static_cast<float>(left);
                const float* p =
                    padded.data() + static_cast<std::size_t>(top) * stride + static_cast<std::size_t>(left);
                const float above = p[0] + right * (p[1] - p[0]);
                const float below = p[stride] + right * (p[stride + 1] - p[stride]);
                to(y, x, channel) = above + down * (below - above);
            }
        }
    }
}

} // namespace tactnet
