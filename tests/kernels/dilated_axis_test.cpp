#include <tactnet/kernels/dilated_axis.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cstddef>

using namespace tactnet;
using kernels::dilated_axis;
using kernels::dilated_layout;
using kernels::phase_order;

namespace {

constexpr std::size_t none = dilated_axis::none;

/// A convolution, whose window has the padding of the dilated kernel.
struct dilated_window {
    sliding_window window;
    extent2d dilation, outputs;

    static constexpr dilated_window over(extent2d input, extent2d kernel, extent2d dilation,
                                         extent2d stride = 1, padding around = padding::same) {
        const sliding_window reach = sliding_window::over(
            {input.rows, input.columns, 1},
            {(kernel.rows - 1) * dilation.rows + 1, (kernel.columns - 1) * dilation.columns + 1}, stride,
            around);
        sliding_window own = reach;
        own.kernel = kernel;
        return {own, dilation, {reach.fits() ? reach.output_rows() : 0, reach.output_columns()}};
    }
    [[nodiscard]] constexpr dilated_layout layout() const {
        return dilated_layout::of(window, dilation, outputs);
    }
    [[nodiscard]] dilated_layout layout(phase_order rows) const {
        return dilated_layout::of(window, dilation, outputs, rows);
    }
    /// The input pixel under a tap of an output, by the definition.
    [[nodiscard]] std::size_t pixel(extent2d output, extent2d tap) const {
        const std::size_t row = output.rows * window.stride.rows + tap.rows * dilation.rows - window.top,
                          column = output.columns * window.stride.columns + tap.columns * dilation.columns -
                                   window.left;
        return row < window.input.rows && column < window.input.columns ? row * window.input.columns + column
                                                                        : none;
    }
};

/// The input pixel under a tap of the convolution of the phases.
std::size_t pixel_of_phases(const dilated_layout& layout, const sliding_window& w, std::size_t columns,
                            std::size_t sum, extent2d tap) {
    const std::size_t row = sum / w.output_columns() * w.stride.rows + tap.rows - w.top,
                      column = sum % w.output_columns() * w.stride.columns + tap.columns - w.left;
    if (row >= w.input.rows || column >= w.input.columns)
        return none;
    const std::size_t place = row * w.input.columns + column, width = layout.along.pixels(),
                      from_row = layout.down.input_at(place / width),
                      from_column = layout.along.input_at(place % width);
    return from_row == none || from_column == none ? none : from_row * columns + from_column;
}

/// Taps whose pixel is not that of the definition, and maps of other sizes than the tables of the axes.
std::size_t mistakes(const dilated_window& c, const dilated_layout& layout) {
    const sliding_window w = layout.window();
    std::size_t found = 0;
    const auto check = [&](bool right) { found += right ? 0 : 1; };
    check(w.input.area() == layout.down.pixels() * layout.along.pixels());
    check(w.output_rows() * w.output_columns() == layout.down.sums() * layout.along.sums());
    check(w.top < w.kernel.rows && w.bottom < w.kernel.rows);
    check(w.left < w.kernel.columns && w.right < w.kernel.columns);
    for (std::size_t o = 0; o < c.outputs.area(); ++o)
        for (std::size_t t = 0; t < w.kernel.area(); ++t) {
            const extent2d output(o / c.outputs.columns, o % c.outputs.columns),
                tap(t / w.kernel.columns, t % w.kernel.columns);
            check(pixel_of_phases(layout, w, c.window.input.columns,
                                  layout.sum_of(output.rows, output.columns), tap) == c.pixel(output, tap));
        }
    return found;
}

} // namespace

TEST_CASE("dilated_layout: each tap of each output has the pixel of the definition, in both layouts") {
    constexpr std::array paddings{padding::same,   padding::valid,  pad(1),
                                  pad(2, 0, 1, 3), pad(0, 5, 3, 0), ceil_mode(pad(1))};
    std::size_t wrong = 0, compared = 0;
    for (const std::size_t rows : {1U, 2U, 5U, 8U, 11U, 14U})
        for (const std::size_t columns : {1U, 4U, 9U})
            for (const extent2d kernel : {extent2d(1, 2), extent2d(2), extent2d(3), extent2d(4, 3)})
                for (const extent2d dilation : {extent2d(1, 2), extent2d(2), extent2d(3, 1), extent2d(3),
                                                extent2d(4), extent2d(5), extent2d(5, 2)})
                    for (const extent2d stride : {extent2d(1), extent2d(2), extent2d(3, 1)})
                        for (const padding& around : paddings) {
                            const auto c = dilated_window::over(extent2d(rows, columns), kernel, dilation,
                                                                stride, around);
                            if (!c.window.fits() || c.outputs.rows == 0)
                                continue;
                            ++compared;
                            wrong += mistakes(c, c.layout(phase_order::consecutive));
                            wrong += mistakes(c, c.layout(phase_order::interleaved));
                        }
    CHECK(wrong == 0);
    CHECK(compared > 5000);
}

// Phases below each other have 19 × 31 outputs in 40 tiles of 4 × 4; side by side, 4 × 124 in 31.
static_assert(dilated_window::over({14, 25}, 3, 4).layout().phases_in_row == 4);
static_assert(dilated_window::over({14, 25}, 3, 4).layout().window().input == shape{4, 124, 1});
static_assert(dilated_window::over({14, 25}, 3, 4).layout().window().output_rows() == 4);
static_assert(dilated_window::over({14, 25}, 3, 4).layout().window().output_columns() == 124);
// 15 × 27 outputs in 28 tiles, as many as 7 × 54 side by side.
static_assert(dilated_window::over({14, 25}, 3, 2).layout().phases_in_row == 1);
// 5 × 5 kernels have no tiles: side by side they have fewer taps on the zeros between phases.
static_assert(dilated_window::over({28, 50}, 5, 2).layout().phases_in_row == 2);
