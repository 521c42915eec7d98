#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/fused_activation.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>

// The convolution of one frame as a compile-time description: what is computed, and how it is cut into
// register blocks. Each method of computing it (frame/direct.hpp, …) is a template on this
// description; frame/methods.hpp chooses one.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// A convolution and its epilogue: a sum with another map or a max pool of windows side by side, then an
/// activation function.
struct frame_convolution {
    sliding_window window;
    std::size_t filters;
    std::size_t input_stride; ///< elements from one pixel of the input to the next
    extent2d pool = 1;        ///< window and stride of the max pool, without padding before the image
    std::size_t pooled_rows = 0, pooled_columns = 0; ///< of the output, if the pool cuts or completes windows
    const fused_activation* activation = &no_activation; ///< the function that follows
    bool accumulates = false;                            ///< whether it accumulates into the output map
    std::size_t groups = 1;     ///< filters of a group see the channels of that group only
    std::size_t map_stride = 0; ///< elements from one pixel to the next of a wider map that holds the output
    std::size_t map_offset = 0; ///< channels of that map before the output
    /// For one of several groups: a common divisor of the first channels of all groups, in the output map and
    /// in the input.
    std::size_t map_offset_multiple = 0, input_offset_multiple = 0;

    /// Lanes of a vector of filters. In a wider map, vectors are aligned and hold no lanes but those of the
    /// filters.
    [[nodiscard]] constexpr std::size_t width() const {
        std::size_t w = lanes_for<float>(filters);
        while (w > min_lanes<float> && map_stride > 0 && !fills_vectors_of(w))
            w /= 2;
        return w;
    }
    [[nodiscard]] constexpr std::size_t vectors() const { return ceil_div(filters, width()); }
    [[nodiscard]] constexpr std::size_t padded_filters() const { return vectors() * width(); }
    [[nodiscard]] constexpr std::size_t output_stride() const {
        return map_stride > 0 ? map_stride : padded_filters();
    }
    /// Whether the activation function is a ReLU.
    [[nodiscard]] constexpr bool rectifies() const { return activation->rectifies; }
    /// Multiply-adds of one output.
    [[nodiscard]] constexpr std::size_t taps() const {
        return window.input.channels / groups * window.kernel.area();
    }
    /// Elements of the packed weights, then of the biases.
    [[nodiscard]] constexpr std::size_t weights() const { return taps() * padded_filters(); }

    /// Whether the output can be written to its place in a wider map, and touches nothing else there. Lanes
    /// of the map after its last channel are the caller's responsibility.
    [[nodiscard]] constexpr bool fits_map() const {
        return map_stride == 0 ||
               (fills_vectors_of(width()) && (map_offset_multiple > 0 || map_offset + filters <= map_stride));
    }
    /// Whether groups can be computed one by one: the filters of a group fill vectors, and all filters the
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
    /// All groups as one convolution, whose weights between different groups are zero.
    [[nodiscard]] constexpr frame_convolution ungrouped() const {
        frame_convolution all = *this;
        all.groups = 1;
        return all;
    }

    static constexpr std::size_t max_block_vectors = vector_registers >= 16 ? 2 : 1;
    /// The most pixels of a pool's window that a register block of every instruction set holds. With 32
    /// registers a block holds twice as many, but a convolution and a separate pool of 3 × 3 are faster.
    static constexpr std::size_t max_pool_area = 6;
    static_assert(max_block_vectors * max_pool_area <= max_block_sums);

    /// Whether each channel is a group of its own, with one filter or several (a multiplier above 1).
    [[nodiscard]] constexpr bool is_depthwise() const {
        return groups > 1 && groups == window.input.channels;
    }

    [[nodiscard]] constexpr std::size_t output_rows() const {
        return pooled_rows > 0 ? pooled_rows : window.output_rows();
    }
    [[nodiscard]] constexpr std::size_t output_columns() const {
        return pooled_columns > 0 ? pooled_columns : window.output_columns();
    }
    /// Rows and columns before pooling that the output depends on.
    [[nodiscard]] constexpr std::size_t rows() const {
        return std::min(window.output_rows(), output_rows() * pool.rows);
    }
    [[nodiscard]] constexpr std::size_t columns() const {
        return std::min(window.output_columns(), output_columns() * pool.columns);
    }

    /// Multiply-adds of vectors, those on padding left out.
    [[nodiscard]] constexpr std::uint64_t vector_products() const {
        return std::uint64_t{window.taps_on_pixels()} * (window.input.channels / groups) * vectors();
    }
    /// Whether both maps together or the weights exceed what near caches hold. No convolution of the networks
    /// for tactile images does.
    [[nodiscard]] constexpr bool exceeds_near_caches() const {
        return window.input.size() + rows() * columns() * filters >= 40'000 ||
               weights() >= std::size_t{256} * 1024;
    }
    /// Whether each pixel of the input holds whole vectors of so many lanes.
    [[nodiscard]] constexpr bool input_in_vectors_of(std::size_t lanes_of_vector) const {
        const std::size_t vectors_of_input = ceil_div(window.input.channels, lanes_of_vector);
        return input_stride % lanes_of_vector == 0 && input_stride >= vectors_of_input * lanes_of_vector &&
               input_offset_multiple % lanes_of_vector == 0;
    }

    /// Vectors of output channels in a register block.
    [[nodiscard]] constexpr std::size_t block_vectors() const {
        return std::min<std::size_t>(vectors(), max_block_vectors);
    }

    [[nodiscard]] constexpr std::size_t block_rows() const {
        return pool.rows > 1 ? pool.rows : std::min<std::size_t>(rows(), 2);
    }
    [[nodiscard]] constexpr std::size_t block_columns() const {
        return block_columns(max_block_sums / (block_rows() * block_vectors()));
    }
    /// Columns of a block: at most so many, in whole windows of the pool and blocks of nearly the same size.
    [[nodiscard]] constexpr std::size_t block_columns(std::size_t most) const {
        const std::size_t step = pool.columns;
        most = std::max(most / step * step, step);
        const std::size_t blocks = ceil_div(columns(), most);
        const std::size_t even = ceil_div(columns(), blocks);
        return round_up(even, step);
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

/// The activation function of a convolution, if registers hold it, applied to a vector of its outputs.
template <frame_convolution C, class Vector>
[[nodiscard]] [[gnu::always_inline]] inline Vector activated(const Vector& x) {
    if constexpr (!C.activation->in_registers) {
        return x;
    } else if constexpr (C.activation->rectifies) {
        return maximum_or_second(Vector(0.0f), x);
    } else {
        constexpr auto function = C.activation->template of<Vector>();
        return function(x);
    }
}

/// Any other activation function, applied to `rows` × `columns` stored outputs, of so many filters.
template <frame_convolution C>
[[gnu::always_inline]] inline void activate_outputs(float* output, std::size_t rows, std::size_t columns,
                                                    std::size_t filters = C.padded_filters()) {
    if constexpr (C.activation->exists && !C.activation->in_registers)
        activate_stored<C.activation, C.width()>(
            {output, rows, C.output_columns() * C.output_stride(), columns, C.output_stride(), filters});
}

/// What methods have unless they say otherwise. Costs are counted in twentieths of a multiply-add of a
/// vector; their constants are rounded from times of layers (benchmark_plan) on several processors, with 16
/// and 32 registers.
struct frame_method {
    static constexpr extent2d tile = 0;      ///< outputs of a Winograd tile
    static constexpr bool layerwise = false; ///< whether frames go through it together, and threads share it
    /// No sum inside a method exceeds so many times the bound of its outputs. Winograd's factors add up to
    /// 13.8 for one weight, 189 in two directions. One number for all methods: limits of inputs, which files
    /// hold, must not depend on the method, which the instruction set decides.
    static constexpr double max_intermediate_growth = 256;
    static constexpr std::size_t frames_together = 1;    ///< frames that run_frames computes in one call
    static constexpr std::size_t workspace_elements = 0; ///< whole cache lines

    static constexpr std::uint64_t product = 20; ///< the cost of a multiply-add of a vector
    static constexpr bool wide_vectors = lanes<float> >= 8;
    /// The cost of a multiply-add in a register block of direct taps: with 16 wide registers, it has too few
    /// sums to hide the latency and reaches about 60 % of the peak.
    static constexpr std::uint64_t direct_product = wide_vectors && vector_registers < 32 ? 26 : product;
    /// The penalty of methods that read weights and maps again for each register block. They wait for memory
    /// once these exceed the near caches; the factor makes panels win wherever they apply.
    static constexpr std::uint64_t memory_penalty(const frame_convolution& c) {
        return c.exceeds_near_caches() ? 16 : 1;
    }
};

}}} // namespace tactnet::kernels
