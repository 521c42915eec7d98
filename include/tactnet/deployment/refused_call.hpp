#pragma once

#include <tactnet/deployment/frame_ref.hpp>
#include <tactnet/networks/recognition.hpp>

#include <cstddef>
#include <optional>
#include <span>
#include <type_traits>

// The errors for calls that a deployed network does not take: one sentence with what was expected and found,
// in place of a list of all overloads.

namespace tactnet { inline namespace TACTNET_ARCH {

class thread_pool;

template <class Element>
concept frame_has_type = detail::is_count_or_float<Element>; // one expression, which compilers show
template <std::size_t Elements, std::size_t ExpectedElements>
concept frame_has_size = (Elements == ExpectedElements);
template <std::size_t Rows, std::size_t Columns, std::size_t Channels, std::size_t ExpectedRows,
          std::size_t ExpectedColumns, std::size_t ExpectedChannels>
concept frame_has_shape =
    (Rows == ExpectedRows) && (Columns == ExpectedColumns) && (Channels == ExpectedChannels);
template <class Element>
concept outputs_have_type = std::is_same_v<Element, float>;
template <std::size_t Elements, std::size_t ExpectedElements>
concept outputs_have_size = (Elements == ExpectedElements);

namespace detail {

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

/// The error about a frame.
template <class Frame, shape Input>
void refuse_frame() {
    using plain = std::remove_cvref_t<Frame>;
    using element = std::remove_const_t<element_of<Frame>>;
    constexpr shape found = shape_of<plain>;
    if constexpr (requires(const plain& frame) { frame.template as<Input>(); })
        static_assert(std::is_void_v<Frame>,
                      "deployed: the size of this frame is known at run time only: check it with "
                      "frame.as<network::input_shape>(), which returns nothing for another size, and pass "
                      "what that holds");
    else if constexpr (!frame_has_type<element>)
        refuse_type<element>();
    else if constexpr (found != shape{0, 0, 0})
        refuse_shape<found.rows, found.columns, found.channels, Input.rows, Input.columns, Input.channels>();
    else if constexpr (elements_of<plain> != 0)
        refuse_size<elements_of<plain>, Input.size()>();
    else
        static_assert(std::is_void_v<Frame>,
                      "deployed: the size of this frame is known at run time only: check it with "
                      "try_view<network::input_shape>(frame), which returns nothing for another size, and "
                      "pass what that holds");
}

template <class Found>
void refuse_outputs_of() {
    static_assert(outputs_have_type<Found>,
                  "deployed: outputs are written to float, which must not be const; outputs_have_type shows "
                  "what was found");
}
template <class Outputs>
void refuse_temporary_outputs() {
    static_assert(std::is_void_v<Outputs>,
                  "deployed: outputs are written to a contiguous container of float that outlives the call, "
                  "such as a std::vector, std::array or std::span; a pointer or a temporary is none");
}
template <std::size_t Found, std::size_t Expected>
void refuse_number_of_outputs() {
    static_assert(outputs_have_size<Found, Expected>,
                  "deployed: there is room for another number of outputs than the network has; "
                  "outputs_have_size shows found, expected");
}

/// The error about outputs.
template <class Outputs, std::size_t Expected>
void refuse_outputs() {
    using plain = std::remove_cvref_t<Outputs>;
    using element = element_of<Outputs>;
    if constexpr (!outputs_have_type<element>)
        refuse_outputs_of<element>();
    else if constexpr (elements_of<plain> == Expected || std::is_pointer_v<plain>)
        refuse_temporary_outputs<Outputs>();
    else if constexpr (elements_of<plain> != 0)
        refuse_number_of_outputs<elements_of<plain>, Expected>();
    else
        static_assert(std::is_void_v<Outputs>,
                      "deployed: the number of these outputs is known at run time only: check it, then pass "
                      "std::span<float, network::outputs>(outputs)");
}

/// Never defined: if no static_assert below fires, linking fails.
template <class Result, class... Arguments>
Result not_taken() noexcept;

/// The error about frames for a pool.
template <class Frames, shape Input>
void refuse_frames() {
    using element = std::remove_const_t<element_of<Frames>>;
    if constexpr (!requires(const std::remove_cvref_t<Frames>& frames) { frames.data() + frames.size(); })
        static_assert(
            std::is_void_v<Frames>,
            "deployed: frames for a pool are a contiguous container with data() and size(), such as "
            "std::vector, std::array or std::span");
    else if constexpr (is_view<element>)
        static_assert(std::is_void_v<Frames>,
                      "deployed: frames for a pool lie one after the other in memory, which views need not: "
                      "copy what they show, or call with each frame");
    else if constexpr (shape_of<element> != shape{0, 0, 0} || elements_of<element> != 0)
        refuse_frame<element, Input>();
    else
        refuse_type<element>();
}

/// Calls with arguments that a deployed network does not take. Its own calls, which are no templates, go
/// before these.
template <shape Input, std::size_t Outputs>
class refused_calls {
    template <class Frame>
    static constexpr bool is_frame = std::is_convertible_v<Frame, frame_ref<Input>>;
    template <class Frames>
    static constexpr bool is_frames = std::is_convertible_v<Frames, frames_ref<Input>>;
    template <class... Arguments>
    static constexpr bool has_pool = (std::is_same_v<std::remove_cvref_t<Arguments>, thread_pool> || ...);
    template <class Frame, class To, class... Rest>
    static constexpr bool takes =
        has_pool<Rest...> ? is_frames<Frame> && std::is_convertible_v<To, std::span<float>>
                          : is_frame<Frame> && std::is_convertible_v<To, std::span<float, Outputs>>;

public:
    template <class Frame, class To, class... Rest>
        requires(!takes<Frame, To, Rest...>)
    frame_status infer(Frame&&, To&&, Rest&&...) const noexcept {
        if constexpr (has_pool<Rest...> && is_frames<Frame> && outputs_have_type<element_of<To>>)
            refuse_temporary_outputs<To>();
        else if constexpr (has_pool<Rest...> && is_frames<Frame>)
            refuse_outputs_of<element_of<To>>();
        else if constexpr (has_pool<Rest...>)
            refuse_frames<Frame, Input>();
        else if constexpr (is_frame<Frame>)
            refuse_outputs<To, Outputs>();
        else
            refuse_frame<Frame, Input>();
        return not_taken<frame_status, Frame, To>();
    }
    template <class Frame, class... Rest>
        requires(has_pool<Rest...> ? !is_frames<Frame> : !is_frame<Frame>)
    std::optional<recognition> classify(Frame&&, Rest&&...) const noexcept {
        if constexpr (has_pool<Rest...>)
            refuse_frames<Frame, Input>();
        else
            refuse_frame<Frame, Input>();
        return not_taken<std::optional<recognition>, Frame>();
    }
};

} // namespace detail

}} // namespace tactnet
