#pragma once

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

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Rows or columns of a dilated convolution and of the map of its phases.
struct dilated_axis {
    std::size_t inputs, outputs, kernel, dilation, stride, before;
    std::size_t phases;      ///< at most as many as outputs
    std::size_t step;        ///< stride of the convolution of the phases
    std::size_t length = 0;  ///< pixels of the first phase, with zeros, which is the longest
    std::size_t spacing = 0; ///< pixels from the start of one phase to that of the next: whole strides
    std::size_t zeros_before = 0, zeros_after = 0; ///< at both ends of all phases: padding

    static constexpr std::size_t none = static_cast<std::size_t>(-1);

    /// With `before` zeros before the inputs, and at least one output.
    [[nodiscard]] static constexpr dilated_axis of(std::size_t inputs, std::size_t outputs,
                                                   std::size_t kernel, std::size_t dilation,
                                                   std::size_t stride, std::size_t before) {
        const std::size_t common = std::gcd(dilation, stride);
        dilated_axis a{
            inputs,         outputs, kernel, dilation, stride, before, std::min(dilation / common, outputs),
            stride / common};
        a.length = a.used(0);
        a.spacing = a.length - std::min(kernel - 1, a.length / 2);
        while (a.spacing % a.step != 0 || a.phases_collide())
            ++a.spacing;
        const auto extends_padding = [&](std::size_t zeros, std::size_t next) {
            return zeros + 1 < kernel && a.pixels() > 1 && a.padded_input_at(next) == none;
        };
        while (extends_padding(a.zeros_before, a.zeros_before))
            ++a.zeros_before;
        while (extends_padding(a.zeros_after, a.padded() - 1 - a.zeros_after))
            ++a.zeros_after;
        return a;
    }
    /// The pixels of all phases, with the zeros between them and without the padding.
    [[nodiscard]] constexpr std::size_t pixels() const { return padded() - zeros_before - zeros_after; }
    /// The outputs of their convolution.
    [[nodiscard]] constexpr std::size_t sums() const { return (padded() - kernel) / step + 1; }
    /// The input in a place of the phases, or none for a zero.
    [[nodiscard]] constexpr std::size_t input_at(std::size_t place) const {
        return padded_input_at(zeros_before + place);
    }
    /// Where the convolution of the phases computes an output.
    [[nodiscard]] constexpr std::size_t sum_of(std::size_t output) const {
        return output % phases * (spacing / step) + output / phases;
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
    [[nodiscard]] constexpr std::size_t padded() const { return (phases - 1) * spacing + length; }
    [[nodiscard]] constexpr std::size_t padded_input_at(std::size_t place) const {
        const std::size_t phase = std::min(place / spacing, phases - 1);
        const std::size_t found = input_of(phase, place - phase * spacing);
        return found != none || phase == 0 ? found : input_of(phase - 1, place - (phase - 1) * spacing);
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

/// The phases of a convolution over a map, whose window has the padding of the dilated kernel.
template <sliding_window Window, extent2d Dilation, extent2d Outputs>
struct dilated_phases {
    static constexpr dilated_axis down = dilated_axis::of(Window.input.rows, Outputs.rows, Window.kernel.rows,
                                                          Dilation.rows, Window.stride.rows, Window.top);
    static constexpr dilated_axis along =
        dilated_axis::of(Window.input.columns, Outputs.columns, Window.kernel.columns, Dilation.columns,
                         Window.stride.columns, Window.left);
    using rows = dilated_places<down>;
    using columns = dilated_places<along>;
    static constexpr extent2d step{down.step, along.step};
    static constexpr padding around =
        pad(down.zeros_before, down.zeros_after, along.zeros_before, along.zeros_after);
};

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
