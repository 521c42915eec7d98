#pragma once

#include <tactnet/tensor/tensor.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

// What a deployed network takes and what it reports: frames that someone else owns, and the status of a call.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The result of a call. Check it: the outputs of a broken frame look like any others.
enum class [[nodiscard]] frame_status {
    ok,
    not_finite ///< NaN or infinity in the frame or in the outputs, or a number so large that sums in the
               ///< network might leave the range of single precision: the outputs mean nothing
};

namespace detail {

template <class Element>
inline constexpr bool is_count_or_float =
    std::is_same_v<Element, std::uint8_t> || std::is_same_v<Element, float>;

/// The number of elements, as far as the type of an argument knows it, otherwise 0.
template <class Argument>
inline constexpr std::size_t elements_of = 0;
template <class T, std::size_t Size>
inline constexpr std::size_t elements_of<std::array<T, Size>> = Size;
template <class T, std::size_t Size>
inline constexpr std::size_t elements_of<T[Size]> = std::is_array_v<T> ? 0 : Size;
template <class T, std::size_t Size>
inline constexpr std::size_t elements_of<std::span<T, Size>> = Size == std::dynamic_extent ? 0 : Size;

/// The shape, as far as the type of an argument knows it, otherwise one without elements.
template <class Argument>
inline constexpr shape shape_of{0, 0, 0};
template <class Argument>
    requires requires { typename std::integral_constant<shape, Argument::extents>; }
inline constexpr shape shape_of<Argument> = Argument::extents;
template <class T, std::size_t Rows, std::size_t Columns>
inline constexpr shape shape_of<T[Rows][Columns]>{Rows, Columns};
template <class T, std::size_t Channels, std::size_t Rows, std::size_t Columns>
inline constexpr shape shape_of<T[Channels][Rows][Columns]>{Rows, Columns, Channels};

/// The type of an argument's elements, with its const; void if it has none.
template <class Argument>
[[nodiscard]] auto find_element() {
    using plain = std::remove_reference_t<Argument>;
    if constexpr (std::is_void_v<plain>) // Clang 14 makes an error, not a false, of a reference to it
        return std::type_identity<void>{};
    else if constexpr (std::is_array_v<plain>)
        return std::type_identity<std::remove_all_extents_t<plain>>{};
    else if constexpr (requires(plain& argument) { *argument.data(); })
        return std::type_identity<std::remove_pointer_t<decltype(std::declval<plain&>().data())>>{};
    else if constexpr (requires(plain& argument) { *argument; })
        return std::type_identity<std::remove_reference_t<decltype(*std::declval<plain&>())>>{};
    else
        return std::type_identity<void>{};
}
template <class Argument>
using element_of = typename decltype(find_element<Argument>())::type;

/// A type whose objects are frames of a shape: bytes or floats in one piece, known to be as many.
template <class Frame, shape Shape>
concept frame_of =
    is_count_or_float<std::remove_const_t<element_of<Frame>>> &&
    (shape_of<std::remove_cv_t<Frame>> == Shape || elements_of<std::remove_cv_t<Frame>> == Shape.size());

template <class Frame>
[[nodiscard]] const void* first_element(const Frame& frame) noexcept {
    if constexpr (std::is_array_v<Frame>)
        return &frame;
    else
        return frame.data();
}

template <class Frame>
inline constexpr bool is_view = false;
template <class T, std::size_t Size>
inline constexpr bool is_view<std::span<T, Size>> = true;
template <class T, shape Shape>
inline constexpr bool is_view<tensor_view<T, Shape>> = true;

/// A contiguous container of bytes, of floats, or of frames that lie in it.
template <class Frames, shape Shape, class Element = std::remove_cv_t<element_of<const Frames>>>
concept frames_of = requires(const Frames& frames) { frames.size(); } &&
                    (is_count_or_float<Element> || (frame_of<Element, Shape> && !is_view<Element>));

} // namespace detail

/// A non-owning reference to one frame: bytes as the sensor counts, or floats, ordered
/// [channel][row][column]. Converts from what has the right shape, or as many elements: std::array, a C
/// array, a std::span of fixed size, `tensor`, `tensor_view`. For a std::vector or a dynamic std::span see
/// `try_view`.
template <shape Shape>
class frame_ref {
public:
    template <detail::frame_of<Shape> Frame>
    frame_ref(const Frame& frame) noexcept
        : elements_(detail::first_element(frame)),
          counts_(std::is_same_v<std::remove_const_t<detail::element_of<Frame>>, std::uint8_t>) {}

    /// Calls `body` with the tensor_view of bytes or floats that this is.
    template <class Body>
    decltype(auto) visit(Body&& body) const {
        return counts_
                   ? body(tensor_view<const std::uint8_t, Shape>(static_cast<const std::uint8_t*>(elements_)))
                   : body(tensor_view<const float, Shape>(static_cast<const float*>(elements_)));
    }

private:
    const void* elements_;
    bool counts_;
};

/// Frames that someone else owns, one after the other. Converts from contiguous containers, such as
/// std::vector or std::span, of bytes, of floats, or of anything that converts to a frame_ref; and from
/// labelled images.
template <shape Shape>
class frames_ref {
public:
    template <class Frames>
        requires detail::frames_of<Frames, Shape>
    frames_ref(const Frames& frames) noexcept : first_(frames.data()) {
        using value = std::remove_cv_t<detail::element_of<const Frames>>;
        if constexpr (detail::is_count_or_float<value>) {
            counts_ = std::is_same_v<value, std::uint8_t>;
            elements_ = frames.size();
        } else {
            using element = std::remove_const_t<detail::element_of<value>>;
            counts_ = std::is_same_v<element, std::uint8_t>;
            elements_ = frames.size() * Shape.size();
            distance_ = sizeof(value) / sizeof(element);
        }
    }
    template <class Images>
        requires requires(const Images& images) {
            images.labels;
            std::span<const std::uint8_t>(images.pixels);
        }
    frames_ref(const Images& images) noexcept : frames_ref(std::span<const std::uint8_t>(images.pixels)) {}

    /// How many frames these are.
    [[nodiscard]] std::size_t size() const noexcept { return elements_ / Shape.size(); }
    /// How many elements all frames have together; not a multiple of a frame's if one is cut short.
    [[nodiscard]] std::size_t elements() const noexcept { return elements_; }
    [[nodiscard]] frame_ref<Shape> operator[](std::size_t frame) const noexcept {
        if (counts_)
            return at<std::uint8_t>(frame);
        return at<float>(frame);
    }

private:
    template <class T>
    [[nodiscard]] tensor_view<const T, Shape> at(std::size_t frame) const noexcept {
        return tensor_view<const T, Shape>(static_cast<const T*>(first_) + frame * distance_);
    }

    const void* first_;
    bool counts_ = true;
    std::size_t elements_ = 0, distance_ = Shape.size();
};

}} // namespace tactnet
