#pragma once

#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A sample that someone else owns: `Shape.size()` elements, ordered [channel][row][column]. T may be const.
template <class T, shape Shape>
class tensor_view {
public:
    static constexpr shape extents = Shape;

    constexpr explicit tensor_view(std::span<T, Shape.size()> elements) : data_(elements.data()) {}
    constexpr explicit tensor_view(T* elements) : data_(elements) {}
    constexpr tensor_view(const tensor_view<std::remove_const_t<T>, Shape>& other) requires std::is_const_v<T>
        : data_(other.data()) {}
    /// An array of as many elements, as a program may hold a frame.
    constexpr tensor_view(
        const std::array<std::remove_const_t<T>, Shape.size()>& elements) requires std::is_const_v<T>
        : data_(elements.data()) {}
    constexpr tensor_view(const tensor_view&) = default;
    constexpr tensor_view& operator=(const tensor_view&) = default;

    [[nodiscard]] constexpr T& operator()(std::size_t row, std::size_t column,
                                          std::size_t channel = 0) const {
        return data_[(channel * Shape.rows + row) * Shape.columns + column];
    }
    [[nodiscard]] constexpr T* data() const { return data_; }
    [[nodiscard]] static constexpr std::size_t size() { return Shape.size(); }
    [[nodiscard]] constexpr std::span<T, Shape.size()> elements() const {
        return std::span<T, Shape.size()>(data_, Shape.size());
    }

private:
    T* data_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
