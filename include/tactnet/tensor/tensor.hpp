#pragma once

#include <tactnet/tensor/aligned.hpp>
#include <tactnet/tensor/tensor_view.hpp>

#include <array>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A sample that holds its elements in place, without heap. Ordered [channel][row][column].
template <class T, shape Shape>
class tensor {
public:
    using value_type = T;
    static constexpr shape extents = Shape;

    [[nodiscard]] constexpr T& operator()(std::size_t row, std::size_t column, std::size_t channel = 0) {
        return view()(row, column, channel);
    }
    [[nodiscard]] constexpr const T& operator()(std::size_t row, std::size_t column,
                                                std::size_t channel = 0) const {
        return view()(row, column, channel);
    }
    [[nodiscard]] constexpr T* data() { return elements_.data(); }
    [[nodiscard]] constexpr const T* data() const { return elements_.data(); }
    [[nodiscard]] static constexpr std::size_t size() { return Shape.size(); }
    [[nodiscard]] constexpr auto begin() { return elements_.begin(); }
    [[nodiscard]] constexpr auto end() { return elements_.end(); }
    [[nodiscard]] constexpr auto begin() const { return elements_.begin(); }
    [[nodiscard]] constexpr auto end() const { return elements_.end(); }

    [[nodiscard]] constexpr tensor_view<T, Shape> view() & { return tensor_view<T, Shape>(data()); }
    [[nodiscard]] constexpr tensor_view<const T, Shape> view() const& {
        return tensor_view<const T, Shape>(data());
    }
    void view() const&& = delete; // would dangle
    /// A tensor is an argument wherever a view is expected. A temporary converts too: it lives until the call
    /// returns.
    constexpr operator tensor_view<T, Shape>() { return tensor_view<T, Shape>(data()); }
    constexpr operator tensor_view<const T, Shape>() const { return tensor_view<const T, Shape>(data()); }

private:
    alignas(vector_alignment) std::array<T, Shape.size()> elements_{};
};

}} // namespace tactnet
