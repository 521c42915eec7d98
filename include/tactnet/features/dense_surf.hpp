#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/features/integral_image.hpp>
#include <tactnet/kernels/rows/operations.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <tuple>
#include <utility>

// Upright SURF descriptors on a dense grid (Bay, Ess, Tuytelaars and Van Gool, "Speeded-Up Robust Features
// (SURF)", 2008, section 4.2). A window of 20 s × 20 s pixels has 4 × 4 subregions of 5 × 5 samples, s pixels
// apart. A sample has the responses dx and dy to Haar wavelets of 2 s × 2 s pixels, weighted by a Gaussian of
// 3.3 s around the centre of the window; a subregion has Σdx, Σ|dx|, Σdy and Σ|dy|; the 64 values are
// normalised to unit length. Outside the image are zeros.
//
// The Gaussian is separable: responses are added up along columns first, for all windows of a row at once,
// then along rows.
//
// The grid is dense, since the interest points that SURF detects on photographs are too few on an image of
// some 50 tactels.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Values per SURF descriptor, in the order [row of subregions][column of subregions][dx, |dx|, dy, |dy|].
inline constexpr std::size_t surf_values = 64;

namespace detail {

/// The factors of the Gaussian for the 20 samples of a window.
[[nodiscard]] inline std::array<float, 20> surf_weights() {
    std::array<float, 20> weights{};
    for (std::size_t k = 0; k < weights.size(); ++k) {
        const double distance = (static_cast<double>(k) - 9.5) / 3.3;
        weights[k] = static_cast<float>(std::exp(-distance * distance / 2));
    }
    return weights;
}

/// The places of a grid along one side, centred.
struct grid_side {
    std::size_t first, step, count;

    constexpr grid_side(std::size_t size, std::size_t step_)
        : first((size - 1) % step_ / 2), step(step_), count((size - 1) / step_ + 1) {}
};

/// The descriptors of one scale.
template <shape Shape, extent2d Step, std::size_t Scale>
class surf_scale {
public:
    static constexpr grid_side rows{Shape.rows, Step.rows}, columns{Shape.columns, Step.columns};

    /// Calls put(row of the grid, column of the grid, values) for all descriptors, row by row.
    template <class Integral, class Put>
    void describe(const Integral& integral, const std::array<float, 20>& weights, Put&& put) noexcept {
        respond(integral);
        for (std::size_t row = 0; row < rows.count; ++row) {
            add_columns(top(row), weights);
            alignas(vector_alignment) std::array<float, surf_values> values{};
            for (std::size_t column = 0; column < columns.count; ++column) {
                for (std::size_t part = 0; part < 16; ++part) {
                    const std::size_t first = part % 4 * 5;
                    kernels::weighted_sum<4>(bands_[part / 4].data() + (left(column) + first * Scale) * 4,
                                             4 * Scale, weights.data() + first, 5, values.data() + part * 4);
                }
                put(row, column, values);
            }
        }
    }

private:
    // From the place of a window to its first sample. The centre of the window is the centre of a pixel for
    // odd scales and its upper left corner for even scales, so that wavelets end between pixels.
    static constexpr std::size_t radius = (19 * Scale - Scale % 2) / 2;
    // Nonzero responses: corners less than Scale outside of the image.
    static constexpr std::size_t active_rows = Shape.rows + 2 * Scale - 1;
    static constexpr std::size_t active_columns = Shape.columns + 2 * Scale - 1;
    // Four sums per column, padded to whole cache lines for the widest vectors.
    static constexpr std::size_t response_stride = pad_to_cache_line(active_columns * 4);
    // Columns of zeros before and after the responses, for windows that reach outside of the image.
    static constexpr std::size_t margin = pad_to_cache_line(radius * 4) / 4;
    static constexpr std::size_t band_size =
        margin * 4 +
        std::max(response_stride,
                 pad_to_cache_line((columns.first + (columns.count - 1) * columns.step + 20 * Scale) * 4));

    /// The first sample of a window, in rows of responses; may be negative.
    [[nodiscard]] static constexpr std::ptrdiff_t top(std::size_t row) {
        return static_cast<std::ptrdiff_t>(rows.first + row * rows.step + Scale - 1) -
               static_cast<std::ptrdiff_t>(radius);
    }
    /// The first sample of a window, in columns of a band.
    [[nodiscard]] static constexpr std::size_t left(std::size_t column) {
        return margin + columns.first + column * columns.step + Scale - 1 - radius;
    }

    /// Scales the responses of floating-point pixels to the middle of the range of single precision.
    template <class Integral>
    [[nodiscard]] static typename Integral::value_type factor_for(const Integral& integral) noexcept {
        if constexpr (std::floating_point<typename Integral::value_type>)
            return integral.magnitude() > 0 ? 1 / integral.magnitude() : 0;
        else
            return 1;
    }
    template <class Integral>
    void respond(const Integral& integral) noexcept {
        constexpr auto outside = static_cast<std::ptrdiff_t>(Scale) - 1;
        const auto factor = factor_for(integral);
        for (std::size_t r = 0; r < active_rows; ++r) {
            float* to = responses_.data() + r * response_stride;
            for (std::size_t c = 0; c < active_columns; ++c, to += 4) {
                const auto [dx, dy] = haar_at<Scale>(integral, static_cast<std::ptrdiff_t>(r) - outside,
                                                     static_cast<std::ptrdiff_t>(c) - outside);
                const auto x = static_cast<float>(dx * factor), y = static_cast<float>(dy * factor);
                to[0] = x, to[1] = std::abs(x), to[2] = y, to[3] = std::abs(y);
            }
        }
    }
    /// Computes one band per row of subregions: the sums of every column over its five samples.
    void add_columns(std::ptrdiff_t first_row, const std::array<float, 20>& weights) noexcept {
        constexpr auto s = static_cast<std::ptrdiff_t>(Scale);
        for (std::size_t part = 0; part < 4; ++part) {
            std::size_t k = part * 5, end = k + 5;
            const auto row = [&](std::size_t sample) {
                return first_row + static_cast<std::ptrdiff_t>(sample) * s;
            };
            while (k < end && row(k) < 0)
                ++k;
            while (k < end && row(end - 1) >= static_cast<std::ptrdiff_t>(active_rows))
                --end;
            const std::size_t from = k < end ? static_cast<std::size_t>(row(k)) * response_stride : 0;
            kernels::weighted_sum<response_stride>(responses_.data() + from, response_stride * Scale,
                                                   weights.data() + k, end - k,
                                                   bands_[part].data() + margin * 4);
        }
    }

    alignas(vector_alignment) std::array<float, active_rows * response_stride> responses_{};
    alignas(vector_alignment) std::array<std::array<float, band_size>, 4> bands_{};
};

} // namespace detail

/// The grid of descriptors: every `step` tactels, at up to four nonzero scales. At scale s the window covers
/// 20 s × 20 s tactels.
struct surf_grid {
    extent2d step = 3;
    std::array<std::size_t, 4> scales{1, 2};

    /// Number of scales before the first 0.
    [[nodiscard]] constexpr std::size_t levels() const {
        return static_cast<std::size_t>(std::find(scales.begin(), scales.end(), 0u) - scales.begin());
    }
    friend constexpr bool operator==(const surf_grid&, const surf_grid&) = default;
};

/// The scale and the place on the grid of a descriptor.
struct surf_place {
    std::uint16_t level, row, column;
};

/// Computes the descriptors of images of one size without heap use. Each thread needs an object of its own.
/// `Pixel` is std::uint8_t or float.
template <shape Shape, surf_grid Grid = surf_grid{}, class Pixel = std::uint8_t>
class dense_surf {
    static_assert(
        Shape.channels == 1 && Shape.rows >= 2 && Shape.columns >= 2,
        "dense_surf: expected one map of at least 2 x 2 tactels: a single row or column has no gradient");
    static_assert(Grid.step.rows > 0 && Grid.step.columns > 0, "dense_surf: expected a step of at least 1");
    static_assert(Grid.levels() > 0, "dense_surf: expected at least one scale that is not 0");

public:
    using pixel_type = Pixel;
    using image_view = tensor_view<const Pixel, Shape>;
    static constexpr shape extents = Shape;
    static constexpr detail::grid_side rows{Shape.rows, Grid.step.rows},
        columns{Shape.columns, Grid.step.columns};
    /// Upper bound of the descriptors of one image.
    static constexpr std::size_t most = Grid.levels() * rows.count * columns.count;

    /// Computes the descriptors of an image, except those of zero length, whose window is constant. If the
    /// image has NaN or infinity, returns false and there are no descriptors.
    [[nodiscard]] bool describe(image_view image) noexcept {
        memory& m = *memory_;
        count_ = 0;
        m.integral.compute(image);
        if (!m.integral.finite())
            return false;
        kernels::unroll<Grid.levels()>([&](auto level) {
            std::get<level>(m.scales).describe(
                m.integral, m.weights,
                [&](std::size_t row, std::size_t column, const std::array<float, surf_values>& values) {
                    const float length = kernels::euclidean_norm<surf_values>(values.data());
                    if (length == 0)
                        return;
                    float* to = m.descriptors.data() + count_ * surf_values;
                    std::copy(values.begin(), values.end(), to);
                    kernels::scale_row<surf_values>(to, 1 / length);
                    m.places[count_++] = {static_cast<std::uint16_t>(level), static_cast<std::uint16_t>(row),
                                          static_cast<std::uint16_t>(column)};
                });
        });
        return true;
    }
    /// The descriptors of the last image: 64 values each, of unit length.
    [[nodiscard]] std::span<const float> descriptors() const& noexcept {
        return {memory_->descriptors.data(), count_ * surf_values};
    }
    [[nodiscard]] std::span<const surf_place> places() const& noexcept {
        return {memory_->places.data(), count_};
    }
    void descriptors() const&& = delete; // would dangle
    void places() const&& = delete;      // would dangle

private:
    static constexpr std::size_t largest =
        *std::max_element(Grid.scales.begin(), Grid.scales.begin() + Grid.levels());

    template <std::size_t... Level>
    static auto scales_of(std::index_sequence<Level...>)
        -> std::tuple<detail::surf_scale<Shape, Grid.step, Grid.scales[Level]>...>;

    struct memory {
        integral_image<Pixel, Shape, 2 * largest> integral;
        decltype(scales_of(std::make_index_sequence<Grid.levels()>())) scales;
        alignas(vector_alignment) std::array<float, most * surf_values> descriptors{};
        std::array<surf_place, most> places{};
        std::array<float, 20> weights = detail::surf_weights();
    };

    std::unique_ptr<memory> memory_ = std::make_unique<memory>();
    std::size_t count_ = 0;
};

}} // namespace tactnet
