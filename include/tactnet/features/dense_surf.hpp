#pragma once

#include <tactnet/features/surf_scale.hpp>
#include <tactnet/kernels/simd/unroll.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <tuple>
#include <utility>

// All SURF descriptors of one pressure image, on a grid. Detecting interest points, as SURF does on
// photographs, would leave too few of them on an image of some 50 tactels.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Where descriptors are taken: at every `step` tactels, at each scale that is not 0 (at most four). At scale
/// s the window covers 20 s × 20 s tactels.
struct surf_grid {
    extent2d step = 3;
    std::array<std::size_t, 4> scales{1, 2};

    /// Scales in use: those before the first 0.
    [[nodiscard]] constexpr std::size_t levels() const {
        return static_cast<std::size_t>(std::find(scales.begin(), scales.end(), 0u) - scales.begin());
    }
    friend constexpr bool operator==(const surf_grid&, const surf_grid&) = default;
};

/// Where a descriptor was taken: which scale, and the place on the grid.
struct surf_place {
    std::uint16_t level, row, column;
};

/// Takes the descriptors of images of one size. Holds the memory for one image: calls use no heap, and every
/// thread needs an object of its own. Pixel: std::uint8_t counts, or float.
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
    /// The most descriptors of one image.
    static constexpr std::size_t most = Grid.levels() * rows.count * columns.count;

    /// Takes the descriptors of an image. Those of zero length, where a window sees no change, are left out:
    /// they have no direction. False, and no descriptors, where the image holds NaN or infinity.
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
    /// Those of the last image: 64 values each, of unit length.
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
        alignas(alignment) std::array<float, most * surf_values> descriptors{};
        std::array<surf_place, most> places{};
        std::array<float, 20> weights = detail::surf_weights();
    };

    std::unique_ptr<memory> memory_ = std::make_unique<memory>();
    std::size_t count_ = 0;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
