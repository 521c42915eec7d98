#pragma once

#include <tactnet/kernels/simd/row_vector.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>

// Copies a piece of a map with the padding around it.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

namespace detail {

/// Copies whole vectors; the last overlaps its neighbour.
template <class Vector, std::size_t Lanes>
[[gnu::always_inline]] inline void copy_vectors(const float* from, float* to, std::size_t count) {
    std::size_t i = 0;
    for (; i + Lanes <= count; i += Lanes)
        store_anywhere(to + i, load_unaligned<Vector>(from + i));
    if (i < count)
        store_anywhere(to + count - Lanes, load_unaligned<Vector>(from + count - Lanes));
}
inline void copy_line(const float* from, float* to, std::size_t count) {
    if (count >= lanes<float>)
        copy_vectors<vector<float>, lanes<float>>(from, to, count);
    else if (count >= min_lanes<float>)
        copy_vectors<sized_vector<float, min_lanes<float>>, min_lanes<float>>(from, to, count);
    else
        std::copy_n(from, count, to);
}

} // namespace detail

/// `size` pixels from `top` and `left` on, counted with the padding, which is zero. Pixels of the map are
/// `input_stride` elements apart, those of the copy `stride`, without gaps between its rows.
inline void stage_map(const sliding_window& w, std::size_t input_stride, const float* input, std::size_t top,
                      std::size_t left, extent2d size, std::size_t stride, float* to) {
    const std::size_t channels = w.input.channels;
    const auto kept = [](std::size_t at, std::size_t before, std::size_t first, std::size_t count) {
        return at > before + first ? std::min(at - before - first, count) : 0;
    };
    // The first column of the copy on the image, and the end of these columns.
    const std::size_t begin = w.left > left ? std::min(w.left - left, size.columns) : 0,
                      end = std::max(begin, kept(w.left + w.input.columns, 0, left, size.columns));
    for (std::size_t r = 0; r < size.rows; ++r, to += size.columns * stride) {
        const std::size_t row = top + r;
        if (row < w.top || row >= w.top + w.input.rows) {
            std::fill_n(to, size.columns * stride, 0.0f);
            continue;
        }
        std::fill_n(to, begin * stride, 0.0f);
        std::fill_n(to + end * stride, (size.columns - end) * stride, 0.0f);
        const float* const from =
            input + ((row - w.top) * w.input.columns + left + begin - w.left) * input_stride;
        if (stride == channels && input_stride == channels)
            detail::copy_line(from, to + begin * stride, (end - begin) * channels);
        else
            for (std::size_t column = begin; column < end; ++column)
                detail::copy_line(from + (column - begin) * input_stride, to + column * stride, channels);
    }
}

}}} // namespace tactnet::kernels
