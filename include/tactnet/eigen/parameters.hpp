#pragma once

#include <tactnet/eigen/memory.hpp>

#include <Eigen/Core>

#include <cstddef>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A trained array as a matrix, without a copy: a row for each entry of its first extent, all others side by
/// side. The weights of a dense layer are outputs × inputs, those of a convolution filters × (channels · rows
/// · columns); a bias is one column. The array must outlive it. Throws std::invalid_argument unless there are
/// as many values as the extents say.
///
///     network.for_each_parameter([](const parameter& p, auto values) {
///         if (p.name == "fc.weight")
///             std::cout << map_parameter(p.extents, values).rowwise().norm();
///     });
template <class T>
[[nodiscard]] auto map_parameter(std::span<const std::size_t> extents, std::span<T> values) {
    const std::size_t rows = extents.empty() ? 1 : extents[0];
    std::size_t columns = 1;
    for (std::size_t e = 1; e < extents.size(); ++e)
        columns *= extents[e];
    if (rows * columns != values.size())
        throw std::invalid_argument("map_parameter: expected " + std::to_string(rows) + " x " +
                                    std::to_string(columns) + " values, found " +
                                    std::to_string(values.size()));
    using matrix = row_major_matrix<std::remove_const_t<T>, Eigen::Dynamic, Eigen::Dynamic>;
    return Eigen::Map<std::conditional_t<std::is_const_v<T>, const matrix, matrix>>(
        values.data(), static_cast<Eigen::Index>(rows), static_cast<Eigen::Index>(columns));
}

} // namespace TACTNET_ARCH
} // namespace tactnet
