#pragma once

#include <tactnet/deployment/frame_status.hpp>
#include <tactnet/tensor/tensor_view.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>
#include <utility>

// What the compiler says of a call that a deployed network does not take: one sentence with what was expected
// and found, in place of a list of all the calls that it was not.

namespace tactnet {
inline namespace TACTNET_ARCH {

class thread_pool; // calls with one are no frames: see deploy.hpp

namespace detail {
template <class Element>
inline constexpr bool is_count_or_float =
    std::is_same_v<Element, std::uint8_t> || std::is_same_v<Element, float>;
} // namespace detail

template <class Element>
concept frame_has_type = detail::is_count_or_float<Element>; // one expression, which compilers show
template <std::size_t Elements, std::size_t ExpectedElements>
concept frame_has_size = (Elements == ExpectedElements);
template <std::size_t Rows, std::size_t Columns, std::size_t Channels, std::size_t ExpectedRows,
          std::size_t ExpectedColumns, std::size_t ExpectedChannels>
concept frame_has_shape = (Rows == ExpectedRows) && (Columns == ExpectedColumns) &&
                          (Channels == ExpectedChannels);
template <class Element>
concept outputs_have_type = std::is_same_v<Element, float>;
template <std::size_t Elements, std::size_t ExpectedElements>
concept outputs_have_size = (Elements == ExpectedElements);

namespace detail {

/// Elements of an argument as far as its type tells: 0 is not known.
template <class Argument>
inline constexpr std::size_t elements_of = 0;
template <class T, std::size_t Size>
inline constexpr std::size_t elements_of<std::array<T, Size>> = Size;
template <class T, std::size_t Size>
inline constexpr std::size_t elements_of<T[Size]> = Size;
template <class T, std::size_t Size>
inline constexpr std::size_t elements_of<std::span<T, Size>> = Size == std::dynamic_extent ? 0 : Size;

/// The type of an argument's elements, with its const; void if there are none.
template <class Argument>
[[nodiscard]] auto find_element() {
    using plain = std::remove_reference_t<Argument>;
    if constexpr (requires(plain & argument) { *argument.data(); })
        return std::type_identity<std::remove_pointer_t<decltype(std::declval<plain&>().data())>>{};
    else if constexpr (requires(plain & argument) { *argument; })
        return std::type_identity<std::remove_reference_t<decltype(*std::declval<plain&>())>>{};
    else
        return std::type_identity<void>{};
}
template <class Argument>
using element_of = typename decltype(find_element<Argument>())::type;

template <class Found>
void refuse_type() {
    static_assert(frame_has_type<Found>,
                  "deployed: the elements of a frame are counts, std::uint8_t, or float; "
                  "frame_has_type shows what was found, void if there are none");
}
template <std::size_t Rows, std::size_t Columns, std::size_t Channels, std::size_t ExpectedRows,
          std::size_t ExpectedColumns, std::size_t ExpectedChannels>
void refuse_shape() {
    static_assert(
        frame_has_shape<Rows, Columns, Channels, ExpectedRows, ExpectedColumns, ExpectedChannels>,
        "deployed: the frame has another shape than the network's input; frame_has_shape shows its rows, "
        "columns and channels, then those expected");
}
template <std::size_t Found, std::size_t Expected>
void refuse_size() {
    static_assert(frame_has_size<Found, Expected>,
                  "deployed: the frame has another number of elements than the network's input; "
                  "frame_has_size shows found, expected");
}

/// The sentence about a frame.
template <class Frame, shape Input>
void refuse_frame() {
    using plain = std::remove_cvref_t<Frame>;
    using element = std::remove_const_t<element_of<Frame>>;
    if constexpr (requires(const plain& frame) { frame.template as<Input>(); })
        static_assert(std::is_void_v<Frame>,
                      "deployed: the size of this frame is known when running only: compare it by "
                      "frame.as<network::input_shape>(), which is nothing if it is another, and give what "
                      "that holds");
    else if constexpr (!frame_has_type<element>)
        refuse_type<element>();
    else if constexpr (requires { typename std::integral_constant<shape, plain::extents>; })
        refuse_shape<plain::extents.rows, plain::extents.columns, plain::extents.channels, Input.rows,
                     Input.columns, Input.channels>();
    else if constexpr (elements_of<plain> != 0 && elements_of<plain> != Input.size())
        refuse_size<elements_of<plain>, Input.size()>();
    else
        static_assert(std::is_void_v<Frame>,
                      "deployed: the type of this frame does not tell its shape: compare its size, then name "
                      "the shape, as in tensor_view<const float, network::input_shape>(frame.data())");
}

template <class Found>
void refuse_outputs_of() {
    static_assert(outputs_have_type<Found>,
                  "deployed: outputs are written to float, which must not be const; outputs_have_type shows "
                  "what was found");
}
template <std::size_t Found, std::size_t Expected>
void refuse_number_of_outputs() {
    static_assert(outputs_have_size<Found, Expected>,
                  "deployed: there is room for another number of outputs than the network has; "
                  "outputs_have_size shows found, expected");
}

/// The sentence about outputs.
template <class Outputs, std::size_t Expected>
void refuse_outputs() {
    using plain = std::remove_cvref_t<Outputs>;
    using element = element_of<Outputs>;
    if constexpr (!outputs_have_type<element>)
        refuse_outputs_of<element>();
    else if constexpr (elements_of<plain> != 0)
        refuse_number_of_outputs<elements_of<plain>, Expected>();
    else
        static_assert(std::is_void_v<Outputs>,
                      "deployed: the type of these outputs does not tell their number: compare it, then name "
                      "it, as in std::span<float, network::outputs>(outputs)");
}

/// The calls that a deployed network refuses. It takes them in by `using`, beside those that it takes: no
/// call that one of them takes gets here.
template <shape Input, std::size_t Outputs>
class refused_calls {
    template <class Frame>
    static constexpr bool takes_frame =
        std::is_convertible_v<Frame, tensor_view<const std::uint8_t, Input>> ||
        std::is_convertible_v<Frame, tensor_view<const float, Input>>;
    template <class To>
    static constexpr bool takes_outputs = std::is_convertible_v<To, std::span<float, Outputs>>;
    template <class Pool>
    static constexpr bool is_pool = std::is_same_v<std::remove_cvref_t<Pool>, thread_pool>;

protected:
    template <class Frame>
    static constexpr bool refuses_frame = !takes_frame<Frame> && !is_pool<Frame>;

public:
    template <class Frame, class To, class... Memory>
    requires refuses_frame<Frame> frame_status operator()(Frame&&, To&&, Memory&&...) const noexcept {
        refuse_frame<Frame, Input>();
        return {};
    }
    template <class Frame, class To, class... Memory>
        requires(takes_frame<Frame> && !takes_outputs<To> && !std::is_void_v<element_of<To>>)
    frame_status operator()(Frame&&, To&&, Memory&&...) const noexcept {
        refuse_outputs<To, Outputs>();
        return {};
    }
};

} // namespace detail

} // namespace TACTNET_ARCH
} // namespace tactnet
