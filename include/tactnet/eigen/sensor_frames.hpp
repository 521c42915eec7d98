#pragma once

#include <tactnet/eigen/elements.hpp>
#include <tactnet/eigen/memory.hpp>
#include <tactnet/sensors/frame.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

// Frames of recordings and of live sensors, whose size is known when running only.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A decoded frame as a matrix of rows × columns, without a copy: valid as long as its cells, for a decoder's
/// frame until the decoder's next call. Throws std::invalid_argument unless there are rows × columns cells.
[[nodiscard]] inline auto map_frame(const frame_view& frame) {
    if (frame.cells.size() != frame.rows * frame.columns)
        throw std::invalid_argument("frame: expected " + std::to_string(frame.rows) + " x " +
                                    std::to_string(frame.columns) + " cells, found " +
                                    std::to_string(frame.cells.size()));
    return Eigen::Map<const row_major_matrix<float, Eigen::Dynamic, Eigen::Dynamic>>(
        frame.cells.data(), static_cast<Eigen::Index>(frame.rows), static_cast<Eigen::Index>(frame.columns));
}

/// A float matrix stored row by row as a frame that a decoder might have given, without a copy; the matrix
/// must outlive it. Throws std::invalid_argument if there are gaps between rows.
template <eigen_dense M>
[[nodiscard]] frame_view view_sensor_frame(M&& matrix, std::uint64_t number = 0,
                                           std::optional<double> seconds = std::nullopt) {
    static_assert(std::is_same_v<typename std::remove_cvref_t<M>::Scalar, float>,
                  "view_sensor_frame: cells are of type float; convert them with cast<float>()");
    const std::span<const float> cells = view_elements<std::dynamic_extent>(std::forward<M>(matrix));
    return {number, seconds, static_cast<std::size_t>(matrix.rows()), static_cast<std::size_t>(matrix.cols()),
            cells};
}

} // namespace TACTNET_ARCH
} // namespace tactnet
