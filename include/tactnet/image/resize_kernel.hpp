#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <cstddef>
#include <ratio>

// Where the outputs of a resize lie between its inputs, and what they weigh them by. Both directions are
// treated alike and apart from each other. Pixel centres are at halves: output o of `to` lies at the input
// coordinate (o + ½) · from / to − ½.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What stands beyond the border of an image.
enum class resize_border {
    symmetric, ///< the image reflected: … 1 0 | 0 1 …
    replicate, ///< its last pixel
    left_out   ///< nothing: the taps that remain share the weight
};

namespace detail {

/// std::floor at compile time too.
[[nodiscard]] constexpr std::ptrdiff_t whole_below(double x) {
    const auto towards_zero = static_cast<std::ptrdiff_t>(x);
    return towards_zero - (static_cast<double>(towards_zero) > x);
}

/// The pixel that stands at a position within or beyond `size` pixels, by an edge other than left_out.
[[nodiscard]] constexpr std::size_t pixel_at(std::ptrdiff_t position, std::ptrdiff_t size,
                                             resize_border rule) {
    if (rule == resize_border::replicate)
        return static_cast<std::size_t>(std::clamp(position, std::ptrdiff_t{0}, size - 1));
    const std::ptrdiff_t m = ((position % (2 * size)) + 2 * size) % (2 * size);
    return static_cast<std::size_t>(m < size ? m : 2 * size - 1 - m);
}

} // namespace detail

/// Keys' cubic convolution ("Cubic convolution interpolation for digital image processing", 1981, equation
/// 15), third order for A = −½. Antialiased: support widened by the scale when shrinking. As it is, the one
/// behind the published small images.
template <class A = std::ratio<-1, 2>, bool Antialiased = true,
          resize_border Border = resize_border::symmetric>
struct keys_cubic {
    static constexpr double a = static_cast<double>(A::num) / static_cast<double>(A::den);

    /// At a distance in pixels.
    [[nodiscard]] static constexpr double weight(double distance) {
        const double t = distance < 0 ? -distance : distance;
        if (t <= 1)
            return ((a + 2) * t - (a + 3)) * t * t + 1;
        if (t < 2)
            return ((a * t - 5 * a) * t + 8 * a) * t - 4 * a;
        return 0;
    }
    /// Calls add(input, weight) for each tap around `centre` of weight other than zero; an input may come
    /// several times. The caller normalises.
    template <class Add>
    static constexpr void taps(double centre, double scale, std::size_t inputs, Add&& add) {
        const double narrow = Antialiased ? std::min(scale, 1.0) : 1.0;
        const auto size = static_cast<std::ptrdiff_t>(inputs);
        for (std::ptrdiff_t p = detail::whole_below(centre - 2 / narrow);
             static_cast<double>(p) < centre + 2 / narrow; ++p) {
            const double w = weight(narrow * (centre - static_cast<double>(p)));
            const bool inside = p >= 0 && p < size;
            if (w != 0 && (inside || Border != resize_border::left_out))
                add(inside ? static_cast<std::size_t>(p) : detail::pixel_at(p, size, Border), w);
        }
    }
};

/// What OpenCV's INTER_CUBIC computes.
using opencv_cubic = keys_cubic<std::ratio<-3, 4>, false, resize_border::replicate>;
/// What Pillow's BICUBIC and PyTorch's antialiased bicubic compute.
using pillow_bicubic = keys_cubic<std::ratio<-1, 2>, true, resize_border::left_out>;

/// The paper's equations (1) to (3), repaired: as printed, x = r′ / S always falls on the first of its four
/// neighbours (weights 1, 0, 0, 0), and S is the inverse of the scale. Read as Lagrange's interpolation of
/// degree three in each direction: with x the output's coordinate scaled to the input, x₀ … x₃ the four
/// pixels next to it and
///   Lᵢ(x) = ∏ⱼ≠ᵢ (x − xⱼ) / (xᵢ − xⱼ),
/// an output is the sum over the 4 × 4 neighbourhood of Lᵢ(x) · Lⱼ(y) · pixel(xᵢ, yⱼ). The neighbourhood
/// stays within the image, at whose border x may lie beside its middle: so polynomials up to the third degree
/// come out exactly everywhere, and no rule for the border is needed. There an error of the pixels grows by
/// up to Σ |weights|, which is below 6 in each direction (5.2 for 28 → 227); Keys' stays at 1.25. No
/// antialiasing. In a direction of less than four pixels all of them are taken, which lowers the degree.
struct lagrange_cubic {
    template <class Add>
    static constexpr void taps(double centre, double, std::size_t inputs, Add&& add) {
        const std::size_t nodes = std::min<std::size_t>(inputs, 4);
        const auto last = static_cast<std::ptrdiff_t>(inputs - nodes);
        const auto first =
            static_cast<std::size_t>(std::clamp(detail::whole_below(centre) - 1, std::ptrdiff_t{0}, last));
        for (std::size_t i = 0; i < nodes; ++i) {
            double w = 1;
            for (std::size_t j = 0; j < nodes; ++j)
                if (j != i)
                    w *= (centre - static_cast<double>(first + j)) /
                         (static_cast<double>(i) - static_cast<double>(j));
            if (w != 0)
                add(first + i, w);
        }
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
