#pragma once

#include <tactnet/tensor/shape.hpp>

#include <support/layers/deployed_reference.hpp>
#include <utility>

namespace support {

/// The reference's form of a resolved window.
inline reference_window window_of(const tactnet::sliding_window& w) {
    return {{w.input.channels, w.input.rows, w.input.columns},
            w.kernel.rows,
            w.kernel.columns,
            w.stride.rows,
            w.stride.columns,
            w.top,
            w.bottom,
            w.left,
            w.right};
}
/// A pool of windows side by side that gives rows × columns; the last ones may reach beyond the map.
inline reference_window pool_window(extents3 map, tactnet::extent2d pool, std::size_t rows,
                                    std::size_t columns) {
    const auto beyond = [](std::size_t end, std::size_t size) { return end > size ? end - size : 0; };
    return {map,
            pool.rows,
            pool.columns,
            pool.rows,
            pool.columns,
            0,
            beyond(rows * pool.rows, map.rows),
            0,
            beyond(columns * pool.columns, map.columns)};
}
/// What a convolution of a deployed network computes from its sums: the largest of each window of its pool,
/// and ReLU.
template <class Convolution>
sample pooled_and_rectified(const Convolution& c, sample sums) {
    const std::size_t rows = c.window.output_rows(), columns = c.window.output_columns();
    if (c.pool != tactnet::extent2d(1))
        sums = bounded_max_pool(pool_window({sums.size() / (rows * columns), rows, columns}, c.pool,
                                            c.output_rows(), c.output_columns()),
                                sums);
    return c.rectifies() ? bounded_relu(std::move(sums)) : sums;
}

} // namespace support
