#pragma once

#include <tactnet/kernels/simd/normal_numbers.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace random_purposes {
inline constexpr random_purpose noise{6}; ///< noise of one image in one epoch
} // namespace random_purposes

/// Standard deviations of the noise of counts.
struct pressure_noise {
    double additive = 0; ///< counts
    double relative = 0; ///< fraction of each count

    friend constexpr bool operator==(const pressure_noise&, const pressure_noise&) = default;
};

/// Adds independent normal noise to counts and clamps them at zero; NaN stays. With the stream of
/// (seed, random_purposes::noise, epoch, sample) the noise does not depend on where it is computed.
inline void add_noise(const pressure_noise& noise, const random_stream& random, std::span<float> counts) {
    if (noise == pressure_noise{})
        return;
    kernels::normal_numbers(random).each(counts.size(), [&](std::size_t tactel, float number) {
        float& count = counts[tactel];
        const double value = static_cast<double>(count), share = noise.relative * value;
        const double deviation = std::sqrt(noise.additive * noise.additive + share * share);
        const auto noisy = static_cast<float>(value + deviation * static_cast<double>(number));
        count = noisy < 0 ? 0 : noisy;
    });
}
/// As above, of an image of known size.
template <shape Shape>
void add_noise(const pressure_noise& noise, const random_stream& random, tensor_view<float, Shape> counts) {
    add_noise(noise, random, counts.elements());
}

// Random augmentation of pressure images: ranges, a random motion from them, and its affine transform, which
// transform.hpp applies.

namespace random_purposes {
inline constexpr random_purpose augmentation{2}; ///< augmentation of one image in one epoch
} // namespace random_purposes

/// Ranges of random changes, as if an object was touched elsewhere, in another direction, or harder.
struct augmentation_ranges {
    double reflect_rows = 0;    ///< probability of reflection upside down
    double reflect_columns = 0; ///< probability of reflection left to right
    double translation = 0;     ///< tactels, uniform in ± along both axes
    double rotation = 0;        ///< degrees about the centre, uniform in ±
    double scale = 0;           ///< size, log-uniform in 1 / (1 + scale) … 1 + scale
    double pressure = 0;        ///< all counts, log-uniform in 1 / (1 + pressure) … 1 + pressure
    double shear = 0;           ///< columns per row, uniform in ±
    /// Probability of erasing a rectangle with sides of a tenth to a third of the image (random erasing;
    /// Zhong et al., 2017).
    double erase = 0;
    pressure_noise noise{}; ///< added last, other numbers for each tactel

    /// The ranges in the authors' programs: reflections with probability ½; ± 3 tactels and ± 10° at 28 × 50,
    /// ± 2 and ± 3° at 20 × 35 and 14 × 25, ± 1 and ± 2° at 10 × 18 and 7 × 13.
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

/// A rectangle of an image, in fractions of its sides, 0 … 1.
struct image_part {
    double row = 0, column = 0;   ///< its upper left corner
    double rows = 0, columns = 0; ///< its size

    /// Whether the rectangle has no pixels.
    [[nodiscard]] constexpr bool empty() const { return !(rows > 0 && columns > 0); }
};

/// The changes of one image, in this order, about its centre.
struct image_motion {
    bool reflect_rows = false;    ///< upside down
    bool reflect_columns = false; ///< left to right
    double shear = 0;             ///< columns to the right per row
    double zoom = 1;              ///< factor of the size
    double rotation = 0;          ///< degrees, from down to right
    double row_shift = 0;         ///< tactels down
    double column_shift = 0;      ///< tactels to the right
    double pressure = 1;          ///< factor of all counts
    image_part erased{};          ///< set to no contact

    /// Draws a motion from one stream, which advances equally whichever ranges are empty.
    [[nodiscard]] static image_motion draw(const augmentation_ranges& ranges, random_stream& random) {
        image_motion m;
        m.rotation = random.uniform(-1, 1) * ranges.rotation;
        m.zoom = std::pow(1 + ranges.scale, random.uniform(-1, 1));
        m.row_shift = random.uniform(-1, 1) * ranges.translation;
        m.column_shift = random.uniform(-1, 1) * ranges.translation;
        m.reflect_rows = random.uniform() < ranges.reflect_rows;
        m.reflect_columns = random.uniform() < ranges.reflect_columns;
        m.pressure = std::pow(1 + ranges.pressure, random.uniform(-1, 1));
        m.shear = random.uniform(-1, 1) * ranges.shear;
        const bool erases = random.uniform() < ranges.erase;
        const double rows = random.uniform(0.1, 1.0 / 3), columns = random.uniform(0.1, 1.0 / 3);
        const double row = random.uniform(0, 1 - rows), column = random.uniform(0, 1 - columns);
        if (erases)
            m.erased = {row, column, rows, columns};
        return m;
    }
};

/// An affine map from output to input coordinates, both relative to the centre of the image, a factor of the
/// counts, and a part of the output without contact.
struct image_transform {
    double row_by_row = 1, row_by_column = 0, row_shift = 0;
    double column_by_row = 0, column_by_column = 1, column_shift = 0;
    double gain = 1;
    image_part erased{}; ///< set to no contact

    /// Inverts a motion, since outputs are looked up in the input. Multiples of 90° are exact.
    [[nodiscard]] static image_transform of(const image_motion& m) {
        const auto [cosine, sine] = turn(m.rotation);
        const double c = cosine / m.zoom, s = sine / m.zoom;
        const double row_sign = m.reflect_rows ? -1 : 1, column_sign = m.reflect_columns ? -1 : 1;
        image_transform t{.row_by_row = row_sign * c,
                          .row_by_column = row_sign * s,
                          .column_by_row = column_sign * (-s - m.shear * c),
                          .column_by_column = column_sign * (c - m.shear * s),
                          .gain = m.pressure,
                          .erased = m.erased};
        t.row_shift = -(t.row_by_row * m.row_shift + t.row_by_column * m.column_shift);
        t.column_shift = -(t.column_by_row * m.row_shift + t.column_by_column * m.column_shift);
        return t;
    }
    [[nodiscard]] static image_transform draw(const augmentation_ranges& ranges, random_stream& random) {
        return of(image_motion::draw(ranges, random));
    }

private:
    struct direction {
        double cosine, sine;
    };
    [[nodiscard]] static direction turn(double degrees) {
        constexpr direction quarters[]{{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
        const double rest = std::remainder(degrees, 360.0);
        for (int quarter = -2; quarter <= 2; ++quarter)
            if (rest == 90 * quarter)
                return quarters[(quarter + 4) % 4];
        const double angle = degrees * std::numbers::pi / 180;
        return {std::cos(angle), std::sin(angle)};
    }
};

}} // namespace tactnet
