#pragma once

#include <tactnet/tensor/shape.hpp>

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A range whose elements outlive the full expression: an lvalue, or a view. Functions that keep a view of
/// their argument require it, so that a temporary, which would dangle, does not compile.
template <class Range>
concept borrowed_range =
    std::is_lvalue_reference_v<Range> || std::ranges::enable_borrowed_range<std::remove_cvref_t<Range>>;

/// A view of a sample: `Shape.size()` elements that belong to the caller, ordered [channel][row][column]. T
/// may be const.
template <class T, shape Shape>
class tensor_view {
public:
    static constexpr shape extents = Shape;

    constexpr explicit tensor_view(std::span<T, Shape.size()> elements) : data_(elements.data()) {}
    constexpr explicit tensor_view(T* elements) : data_(elements) {}
    constexpr tensor_view(const tensor_view<std::remove_const_t<T>, Shape>& other)
        requires std::is_const_v<T>
        : data_(other.data()) {}
    /// Views an array of that many elements.
    constexpr tensor_view(const std::array<std::remove_const_t<T>, Shape.size()>& elements)
        requires std::is_const_v<T>
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

/// A view of elements whose number is only known at run time, such as a std::vector or a dynamic std::span;
/// std::nullopt unless there are exactly `Shape.size()` of them.
template <shape Shape, class Range>
    requires borrowed_range<Range> && requires(Range& elements) { std::span(elements); }
[[nodiscard]] constexpr auto try_view(Range&& elements) noexcept {
    const auto all = std::span(elements);
    using view = tensor_view<typename decltype(all)::element_type, Shape>;
    return all.size() == Shape.size() ? std::optional<view>(view(all.data())) : std::optional<view>();
}

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
