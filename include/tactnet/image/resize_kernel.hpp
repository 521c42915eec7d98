#pragma once

#include <tactnet/detail/arithmetic.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <ratio>

// Interpolation kernels, and the taps of every output along one axis that they give. Pixel centres are at
// halves: output o of `to` lies at the input coordinate (o + ½) · from / to − ½. An input with a weight of
// zero is no tap: if it is NaN, the output is not.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The pixels beyond the border of an image.
enum class resize_border {
    symmetric, ///< the image reflected: … 1 0 | 0 1 …
    replicate, ///< its last pixel
    left_out   ///< none: the remaining taps are normalised
};

namespace detail {

/// std::floor, also at compile time.
[[nodiscard]] constexpr std::ptrdiff_t whole_below(double x) {
    const auto towards_zero = static_cast<std::ptrdiff_t>(x);
    return towards_zero - (static_cast<double>(towards_zero) > x);
}

/// The pixel at a position within or beyond `size` pixels, for borders other than left_out.
[[nodiscard]] constexpr std::size_t pixel_at(std::ptrdiff_t position, std::ptrdiff_t size,
                                             resize_border rule) {
    if (rule == resize_border::replicate)
        return static_cast<std::size_t>(std::clamp(position, std::ptrdiff_t{0}, size - 1));
    const std::ptrdiff_t m = ((position % (2 * size)) + 2 * size) % (2 * size);
    return static_cast<std::size_t>(m < size ? m : 2 * size - 1 - m);
}

} // namespace detail

/// Keys' cubic convolution ("Cubic convolution interpolation for digital image processing", 1981, equation
/// 15), of third order for A = −½. Antialiased widens the support by the scale when shrinking. The defaults
/// are those of the published small images.
template <class A = std::ratio<-1, 2>, bool Antialiased = true,
          resize_border Border = resize_border::symmetric>
struct keys_cubic {
    static constexpr double a = static_cast<double>(A::num) / static_cast<double>(A::den);

    /// The weight at a distance in pixels.
    [[nodiscard]] static constexpr double weight(double distance) {
        const double t = distance < 0 ? -distance : distance;
        if (t <= 1)
            return ((a + 2) * t - (a + 3)) * t * t + 1;
        if (t < 2)
            return ((a * t - 5 * a) * t + 8 * a) * t - 4 * a;
        return 0;
    }
    /// Calls add(input, weight) for each tap around `centre` of nonzero weight, possibly several times per
    /// input. Weights are not normalised.
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

/// OpenCV's INTER_CUBIC.
using opencv_cubic = keys_cubic<std::ratio<-3, 4>, false, resize_border::replicate>;
/// Pillow's BICUBIC and PyTorch's antialiased bicubic.
using pillow_bicubic = keys_cubic<std::ratio<-1, 2>, true, resize_border::left_out>;

/// The paper's equations (1) to (3), repaired: as printed, x = r′ / S always falls on the first of its four
/// neighbours (weights 1, 0, 0, 0), and S is the inverse of the scale. Read as Lagrange interpolation of
/// degree three along each axis: with x the coordinate of the output in the input, x₀ … x₃ the four nearest
/// pixels and
///   Lᵢ(x) = ∏ⱼ≠ᵢ (x − xⱼ) / (xᵢ − xⱼ),
/// an output is the sum over the 4 × 4 neighbourhood of Lᵢ(x) · Lⱼ(y) · pixel(xᵢ, yⱼ). The neighbourhood
/// stays within the image, so that polynomials up to degree three are exact everywhere. At the border, errors
/// of pixels grow by up to Σ |weights|, which is below 6 per axis (5.2 for 28 → 227); for Keys' cubic it is
/// at most 1.25. Not antialiased. Along an axis of less than four pixels the degree is lower.
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

namespace detail {

/// Inputs first … first + count − 1 and their weights, which sum to one.
template <class Weights>
struct resize_taps {
    std::size_t first = 0, count = 0;
    Weights weights{};

    /// Calls body(input, weight) for each tap of nonzero weight.
    template <class Body>
    constexpr void for_each(Body&& body) const {
        for (std::size_t t = 0; t < count; ++t)
            if (weights[t] != 0)
                body(first + t, weights[t]);
    }
};

/// Upper bound of the taps of an output.
[[nodiscard]] constexpr std::size_t max_taps(std::size_t from, std::size_t to) {
    return std::min(from, (from > to ? 4 * detail::ceil_div(from, to) : 4) + 2);
}

/// Computes the taps of one output. `taps.weights` holds max_taps zeros before.
template <class Kernel, class Weights>
constexpr void find_taps(std::size_t output, std::size_t from, std::size_t to, resize_taps<Weights>& taps) {
    // One rounding, so that integer coordinates are exact.
    const double centre = (static_cast<double>((2 * output + 1) * from) - static_cast<double>(to)) /
                          static_cast<double>(2 * to);
    const double scale = static_cast<double>(to) / static_cast<double>(from);
    std::size_t first = from, last = 0;
    double sum = 0;
    Kernel::taps(centre, scale, from, [&](std::size_t input, double weight) {
        first = std::min(first, input);
        last = std::max(last, input);
        sum += weight;
    });
    Kernel::taps(centre, scale, from,
                 [&](std::size_t input, double weight) { taps.weights[input - first] += weight / sum; });
    taps.first = first;
    taps.count = last + 1 - first;
}

} // namespace detail

/// The taps of all outputs of a compile-time size, in single precision.
template <class Kernel, std::size_t From, std::size_t To>
struct resize_axis {
    static constexpr std::size_t inputs = From, outputs = To;

private:
    using weights = std::array<double, detail::max_taps(From, To)>;
    static constexpr auto exact = [] {
        std::array<detail::resize_taps<weights>, To> all{};
        for (std::size_t o = 0; o < To; ++o)
            detail::find_taps<Kernel>(o, From, To, all[o]);
        return all;
    }();

public:
    /// Taps per output. Outputs that need fewer have weights of zero.
    static constexpr std::size_t taps = [] {
        std::size_t most = 0;
        for (const auto& each : exact)
            most = std::max(most, each.count);
        return most;
    }();

    /// The taps of one output.
    struct output {
        std::size_t first;
        std::array<float, taps> weights;
    };
    static constexpr std::array<output, To> table = [] {
        std::array<output, To> all{};
        for (std::size_t o = 0; o < To; ++o) {
            all[o].first = std::min(exact[o].first, From - taps);
            for (std::size_t t = 0; t < exact[o].count; ++t)
                all[o].weights[exact[o].first + t - all[o].first] = static_cast<float>(exact[o].weights[t]);
        }
        return all;
    }();
    /// Whether any weight is zero.
    static constexpr bool has_gaps = [] {
        for (const output& each : table)
            for (const float weight : each.weights)
                if (weight == 0)
                    return true;
        return false;
    }();
};

}} // namespace tactnet
