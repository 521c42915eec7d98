#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/caches.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <numeric>

// A dilated convolution reads every `dilation`-th pixel. So it is several convolutions without dilation, one
// for each phase: outputs of equal remainder read pixels of equal remainder. The phases lie side by side in
// one map, and a single convolution computes all of them. Two neighbours share the zeros between them. The
// zeros at the edges are the padding of this convolution, which methods by taps skip. Some of its outputs
// span two phases; they are left out.
//
// The phases of the rows lie one below the other, or side by side as well: then the map is as high as one
// phase, and each of its rows holds a row of every phase. In memory such a map is one of interleaved rows,
// each of which ends with the zeros that separate phases. Deployed, the layout of fewer products is chosen.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// How the phases of an axis lie.
enum class phase_order {
    consecutive, ///< one phase after the other
    repeatable,  ///< the same, ending with the zeros that the phases of another row need before them
    interleaved  ///< the first pixel of each phase, then the second of each
};

/// Rows or columns of a dilated convolution and of the map of its phases.
struct dilated_axis {
    std::size_t inputs, outputs, kernel, dilation, stride, before;
    phase_order order;
    std::size_t phases;      ///< at most as many as outputs
    std::size_t step;        ///< stride of the convolution of the phases
    std::size_t length = 0;  ///< pixels of the first phase, with zeros, which is the longest
    std::size_t spacing = 0; ///< pixels from the start of one phase to that of the next: whole strides
    std::size_t padded = 0;  ///< pixels with padding, of all phases or of each interleaved one
    std::size_t zeros_before = 0, zeros_after = 0; ///< at both ends of `padded`: padding

    static constexpr std::size_t none = static_cast<std::size_t>(-1);

    /// With `before` zeros before the inputs, and at least one output.
    [[nodiscard]] static constexpr dilated_axis of(std::size_t inputs, std::size_t outputs,
                                                   std::size_t kernel, std::size_t dilation,
                                                   std::size_t stride, std::size_t before,
                                                   phase_order order = phase_order::consecutive) {
        const std::size_t common = std::gcd(dilation, stride);
        dilated_axis a{inputs,         outputs, kernel, dilation,
                       stride,         before,  order,  std::min(dilation / common, outputs),
                       stride / common};
        a.length = a.used(0);
        a.spacing = a.length - std::min(kernel - 1, a.length / 2);
        while (a.spacing % a.step != 0 || a.phases_collide())
            ++a.spacing;
        a.padded = a.interleaved() ? a.length : (a.phases - 1) * a.spacing + a.length;
        const auto extends_padding = [&](std::size_t zeros, std::size_t next) {
            return zeros + 1 < kernel && a.zeros_before + a.zeros_after + 1 < a.padded && a.is_zero(next);
        };
        while (extends_padding(a.zeros_before, a.zeros_before))
            ++a.zeros_before;
        if (order == phase_order::repeatable) {
            // The last zeros are also those before the phases of the next row.
            const std::size_t used = (a.phases - 1) * a.spacing + a.used(a.phases - 1);
            std::size_t end = used;
            while (end + a.zeros_before > used && end > 1 && a.is_zero(end - 1))
                --end;
            // As many outputs as strides.
            a.zeros_after = kernel - std::min(kernel, a.step + a.zeros_before);
            a.padded = a.zeros_before + round_up(end, a.step) + a.zeros_after;
            return a;
        }
        while (extends_padding(a.zeros_after, a.padded - 1 - a.zeros_after))
            ++a.zeros_after;
        return a;
    }
    /// The pixels of all phases, with the zeros between them and without the padding.
    [[nodiscard]] constexpr std::size_t pixels() const {
        return (padded - zeros_before - zeros_after) * phases_together();
    }
    /// The outputs of their convolution.
    [[nodiscard]] constexpr std::size_t sums() const {
        return order == phase_order::repeatable ? pixels() / step
                                                : ((padded - kernel) / step + 1) * phases_together();
    }
    /// The input in a place of the phases, or none for a zero.
    [[nodiscard]] constexpr std::size_t input_at(std::size_t place) const {
        return padded_input_at(zeros_before * phases_together() + place);
    }
    /// Where the convolution of the phases computes an output.
    [[nodiscard]] constexpr std::size_t sum_of(std::size_t output) const {
        return interleaved() ? output : output % phases * (spacing / step) + output / phases;
    }
    /// The taps on pixels, over all outputs.
    [[nodiscard]] constexpr std::size_t taps_on_pixels() const {
        std::size_t taps = 0;
        for (std::size_t output = 0; output < outputs; ++output)
            for (std::size_t tap = 0; tap < kernel; ++tap)
                taps += input_of(output % phases, output / phases * step + tap) != none ? 1 : 0;
        return taps;
    }

private:
    [[nodiscard]] constexpr bool interleaved() const { return order == phase_order::interleaved; }
    /// Pixels of different phases next to each other.
    [[nodiscard]] constexpr std::size_t phases_together() const { return interleaved() ? phases : 1; }
    [[nodiscard]] constexpr std::size_t padded_input_at(std::size_t place) const {
        if (interleaved())
            return input_of(place % phases, place / phases);
        const std::size_t phase = std::min(place / spacing, phases - 1);
        const std::size_t found = input_of(phase, place - phase * spacing);
        return found != none || phase == 0 ? found : input_of(phase - 1, place - (phase - 1) * spacing);
    }
    /// Whether a pixel of `padded`, of all phases if they are interleaved, holds no input.
    [[nodiscard]] constexpr bool is_zero(std::size_t pixel) const {
        for (std::size_t place = pixel * phases_together(); place < (pixel + 1) * phases_together(); ++place)
            if (padded_input_at(place) != none)
                return false;
        return true;
    }
    /// The pixels that the outputs of a phase read, with zeros.
    [[nodiscard]] constexpr std::size_t used(std::size_t phase) const {
        return (outputs - phase - 1) / phases * step + kernel;
    }
    [[nodiscard]] constexpr std::size_t input_of(std::size_t phase, std::size_t pixel) const {
        const std::size_t at = stride * phase + dilation * pixel;
        return pixel < used(phase) && at >= before && at - before < inputs ? at - before : none;
    }
    /// Whether two neighbours read the same place, which is not zero for both.
    [[nodiscard]] constexpr bool phases_collide() const {
        for (std::size_t phase = 0; phase + 1 < phases; ++phase)
            for (std::size_t pixel = spacing; pixel < used(phase); ++pixel)
                if (input_of(phase, pixel) != none || input_of(phase + 1, pixel - spacing) != none)
                    return true;
        return false;
    }
};

namespace detail {

/// The index of each of `Count` entries in a table, or `none`.
template <std::size_t Count, std::size_t Size>
[[nodiscard]] constexpr std::array<std::size_t, Count> reversed(const std::array<std::size_t, Size>& table) {
    std::array<std::size_t, Count> result{};
    result.fill(dilated_axis::none);
    for (std::size_t i = 0; i < Size; ++i)
        if (table[i] != dilated_axis::none)
            result[table[i]] = i;
    return result;
}

} // namespace detail

/// Where the phases take their inputs from, where outputs are computed, and both in reverse; `none` where
/// there is nothing.
template <dilated_axis Axis>
struct dilated_places {
    static constexpr auto input_at = [] {
        std::array<std::size_t, Axis.pixels()> table{};
        for (std::size_t i = 0; i < table.size(); ++i)
            table[i] = Axis.input_at(i);
        return table;
    }();
    static constexpr auto sum_of = [] {
        std::array<std::size_t, Axis.outputs> table{};
        for (std::size_t i = 0; i < table.size(); ++i)
            table[i] = Axis.sum_of(i);
        return table;
    }();
    static constexpr auto place_of = detail::reversed<Axis.inputs>(input_at);
    static constexpr auto output_at = detail::reversed<Axis.sums()>(sum_of);
};

/// How the phases of a convolution over a map lie in one map.
struct dilated_layout {
    dilated_axis down, along;
    std::size_t phases_in_row; ///< phases of the rows that lie side by side
    std::size_t channels;

    /// The layout of fewer products, for a window with the padding of the dilated kernel. It follows from the
    /// sizes alone: all instruction sets and number formats have the same steps.
    [[nodiscard]] static constexpr dilated_layout of(const sliding_window& w, extent2d dilation,
                                                     extent2d outputs) {
        const dilated_layout stacked = of(w, dilation, outputs, phase_order::consecutive),
                             side_by_side = of(w, dilation, outputs, phase_order::interleaved);
        return side_by_side.products() < stacked.products() ? side_by_side : stacked;
    }
    /// With rows that are consecutive or interleaved.
    [[nodiscard]] static constexpr dilated_layout of(const sliding_window& w, extent2d dilation,
                                                     extent2d outputs, phase_order rows) {
        const bool interleaved = rows == phase_order::interleaved;
        const auto down = dilated_axis::of(w.input.rows, outputs.rows, w.kernel.rows, dilation.rows,
                                           w.stride.rows, w.top, rows),
                   along = dilated_axis::of(w.input.columns, outputs.columns, w.kernel.columns,
                                            dilation.columns, w.stride.columns, w.left,
                                            interleaved ? phase_order::repeatable : phase_order::consecutive);
        return {down, along, interleaved ? down.phases : 1, w.input.channels};
    }
    /// The convolution of the phases.
    [[nodiscard]] constexpr sliding_window window() const {
        return {{down.pixels() / phases_in_row, along.pixels() * phases_in_row, channels},
                {down.kernel, along.kernel},
                {down.step, along.step},
                down.zeros_before,
                down.zeros_after,
                along.zeros_before,
                along.zeros_after};
    }
    /// The pixel of its output that is an output of the dilated convolution.
    [[nodiscard]] constexpr std::size_t sum_of(std::size_t row, std::size_t column) const {
        return down.sum_of(row) * along.sums() + along.sum_of(column);
    }

private:
    /// Multiply-adds of one channel and filter, by taps or in Winograd's tiles, whichever are fewer. Unused
    /// outputs count as well.
    [[nodiscard]] constexpr std::size_t products() const {
        const frame_convolution c{.window = window(), .filters = 1, .input_stride = 1};
        std::size_t fewest = c.window.taps_on_pixels();
        for (std::size_t rows = 2; rows <= 5; ++rows)
            for (std::size_t columns = 2; columns <= 5; ++columns)
                if (const extent2d tile(rows, columns); tile_shape_possible(c, tile))
                    fewest = std::min(fewest, tile_count(c, tile) * tile_side(c, tile).area());
        return fewest;
    }
};

/// The phases of a convolution over a map in a layout.
template <dilated_layout Layout>
struct laid_out_phases {
    static constexpr dilated_layout layout = Layout;
    using rows = dilated_places<layout.down>;
    using columns = dilated_places<layout.along>;
    /// The convolution of the phases.
    static constexpr sliding_window window = layout.window();
    static constexpr shape map = window.input;
    static constexpr padding around = pad(window.top, window.bottom, window.left, window.right);
};
/// In the layout of fewer products, for a window with the padding of the dilated kernel.
template <sliding_window Window, extent2d Dilation, extent2d Outputs>
struct dilated_phases : laid_out_phases<dilated_layout::of(Window, Dilation, Outputs)> {};

/// Copies the pixels of a map of `InColumns` columns that the tables name, and fills the others.
template <std::size_t Elements, std::size_t InColumns, class T, std::size_t Rows, std::size_t Columns>
void gather_pixels(const std::array<std::size_t, Rows>& rows, const std::array<std::size_t, Columns>& columns,
                   const T* in, T filling, T* out) {
    for (const std::size_t row : rows)
        for (const std::size_t column : columns) {
            if (row == dilated_axis::none || column == dilated_axis::none)
                std::fill_n(out, Elements, filling);
            else
                std::copy_n(in + (row * InColumns + column) * Elements, Elements, out);
            out += Elements;
        }
}

}}} // namespace tactnet::kernels
