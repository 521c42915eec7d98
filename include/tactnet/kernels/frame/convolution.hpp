#pragma once

#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>
#include <numeric>

// What one fused step of a deployed network computes, and how it is cut into register blocks.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// One fused step: convolution, a sum with another map or a max pool of windows side by side, ReLU.
struct frame_convolution {
    sliding_window window;
    std::size_t filters;
    std::size_t input_stride; ///< elements from one pixel of the input to the next
    extent2d pool = 1;        ///< window and stride of the max pool behind, without padding before the image
    std::size_t pooled_rows = 0, pooled_columns = 0; ///< of the output, if a pool cuts or completes windows
    bool rectified = false;
    bool adds = false;          ///< to the map that the output takes the place of
    std::size_t groups = 1;     ///< filters of a group see the channels of that group only
    std::size_t map_stride = 0; ///< elements from one pixel to the next of a wider map that holds the output
    std::size_t map_offset = 0; ///< channels of that map in front of the output
    std::size_t map_offset_multiple = 0;   ///< of one of several groups: in place of the offset, what all of
                                           ///< theirs are multiples of
    std::size_t input_offset_multiple = 0; ///< the same for the first channels of their inputs

    /// In a wider map vectors must begin where vectors of that width may lie, and hold no lane but the
    /// filters'.
    [[nodiscard]] constexpr std::size_t width() const {
        std::size_t w = lanes_for<float>(filters);
        while (w > min_lanes<float> && map_stride > 0 && !fills_vectors_of(w))
            w /= 2;
        return w;
    }
    [[nodiscard]] constexpr std::size_t vectors() const { return (filters + width() - 1) / width(); }
    [[nodiscard]] constexpr std::size_t padded_filters() const { return vectors() * width(); }
    [[nodiscard]] constexpr std::size_t output_stride() const {
        return map_stride > 0 ? map_stride : padded_filters();
    }
    /// Products of one output.
    [[nodiscard]] constexpr std::size_t taps() const {
        return window.input.channels / groups * window.kernel.area();
    }
    /// Elements of the packed weights, then of the biases.
    [[nodiscard]] constexpr std::size_t weights() const { return taps() * padded_filters(); }

    /// Whether the output can be written to its place in a wider map, and touches nothing else there. What
    /// lies in lanes of the map behind its last channel is the care of whoever owns it.
    [[nodiscard]] constexpr bool fits_map() const {
        return map_stride == 0 ||
               (fills_vectors_of(width()) && (map_offset_multiple > 0 || map_offset + filters <= map_stride));
    }
    /// Whether groups can be computed one by one: their filters must fill vectors, and all of them the
    /// pixels.
    [[nodiscard]] constexpr bool separable_groups() const {
        return groups > 1 && (map_stride > 0 || output_stride() == filters) && one_group().fits_map();
    }
    /// One of several groups, as a convolution from and into some channels of wider maps.
    [[nodiscard]] constexpr frame_convolution one_group() const {
        frame_convolution one = *this;
        one.window.input.channels /= groups, one.filters /= groups, one.groups = 1;
        one.map_stride = output_stride();
        one.map_offset_multiple = std::gcd(map_offset, one.filters);
        one.input_offset_multiple = one.window.input.channels;
        return one;
    }
    /// All groups as one convolution, with zeros for what a group does not see.
    [[nodiscard]] constexpr frame_convolution ungrouped() const {
        frame_convolution all = *this;
        all.groups = 1;
        return all;
    }

    /// Whether there is one filter for each channel, which sees no other.
    [[nodiscard]] constexpr bool is_depthwise() const {
        return groups > 1 && groups == filters && groups == window.input.channels;
    }

    [[nodiscard]] constexpr std::size_t output_rows() const {
        return pooled_rows > 0 ? pooled_rows : window.output_rows();
    }
    [[nodiscard]] constexpr std::size_t output_columns() const {
        return pooled_columns > 0 ? pooled_columns : window.output_columns();
    }
    /// Pixels before pooling that count.
    [[nodiscard]] constexpr std::size_t rows() const {
        return std::min(window.output_rows(), output_rows() * pool.rows);
    }
    [[nodiscard]] constexpr std::size_t columns() const {
        return std::min(window.output_columns(), output_columns() * pool.columns);
    }

    /// Vectors of output channels in a register block.
    [[nodiscard]] constexpr std::size_t block_vectors() const { return std::min<std::size_t>(vectors(), 2); }
    [[nodiscard]] constexpr std::size_t block_rows() const {
        return pool.rows > 1 ? pool.rows : std::min<std::size_t>(rows(), 2);
    }
    /// Columns of a block: as many as registers allow, evenly spread over the image.
    [[nodiscard]] constexpr std::size_t block_columns() const {
        const std::size_t step = pool.columns;
        const std::size_t most =
            std::max(max_block_sums / (block_rows() * block_vectors()) / step * step, step);
        const std::size_t blocks = (columns() + most - 1) / most;
        const std::size_t even = (columns() + blocks - 1) / blocks;
        return (even + step - 1) / step * step;
    }
    friend constexpr bool operator==(const frame_convolution&, const frame_convolution&) = default;

private:
    [[nodiscard]] constexpr bool fills_vectors_of(std::size_t lanes_of_vector) const {
        const std::size_t place = map_offset_multiple > 0 ? map_offset_multiple : map_offset;
        return map_stride % lanes_of_vector == 0 && place % lanes_of_vector == 0 &&
               filters % lanes_of_vector == 0;
    }
};

/// The weights of grouped filters as weights over all channels, zero for channels of other groups: a function
/// of (filter, channel, row, column), from one whose channels are counted in the filter's group.
template <frame_convolution C, class Weight>
[[nodiscard]] constexpr auto ungrouped_weight(const Weight& weight) {
    return [&weight](std::size_t filter, std::size_t channel, std::size_t row, std::size_t column) {
        constexpr std::size_t channels = C.window.input.channels / C.groups;
        const std::size_t first = filter / (C.filters / C.groups) * channels;
        if (C.groups > 1 && (channel < first || channel >= first + channels))
            return decltype(weight(filter, channel, row, column)){};
        return weight(filter, channel - first, row, column);
    };
}

/// Weights in the order of use: blocks of vectors of filters, then [channel][kernel row][kernel
/// column][filter of the block]; zeros where there is no filter. `weight(filter, channel, row, column)`.
template <frame_convolution C, class Weight>
constexpr void pack_frame_weights(float* packed, Weight&& weight) {
    const std::size_t block = C.block_vectors() * C.width();
    for (std::size_t first = 0; first < C.padded_filters(); first += block) {
        const std::size_t count = std::min(block, C.padded_filters() - first);
        for (std::size_t channel = 0; channel < C.window.input.channels; ++channel)
            for (std::size_t row = 0; row < C.window.kernel.rows; ++row)
                for (std::size_t column = 0; column < C.window.kernel.columns; ++column)
                    for (std::size_t f = first; f < first + count; ++f)
                        *packed++ = f < C.filters ? weight(f, channel, row, column) : 0.0f;
    }
}

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
