#pragma once

#include <tactnet/deployment/streaming/chain.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/lowering/stream_step.hpp>
#include <tactnet/operators/activations/layer.hpp>
#include <tactnet/operators/causal_convolution/layer.hpp>
#include <tactnet/operators/dense/layer.hpp>
#include <tactnet/operators/dropout/layer.hpp>
#include <tactnet/operators/last_frame/layer.hpp>
#include <tactnet/operators/recurrent/layer.hpp>
#include <tactnet/operators/residual/layer.hpp>
#include <tactnet/operators/sequence/layer.hpp>
#include <tactnet/operators/sequence/named.hpp>

#include <cstddef>
#include <type_traits>

// How layers become steps of a stream.

namespace tactnet { inline namespace TACTNET_ARCH {

/// The `step` of a layer in a stream, specialised for each layer that can run frame by frame.
template <class Spec, shape Input, class Format = single_precision>
struct stream_lowering;

/// Whether `deploy_stream` can run the layer frame by frame.
template <class Spec, shape Input, class Format = single_precision>
concept runs_in_streams = requires { sizeof(stream_lowering<Spec, Input, Format>); };

namespace detail {

/// Whether a layer changes nothing in a stream, which has one frame at a time and is not trained.
template <class Spec>
inline constexpr bool changes_nothing_in_streams = std::is_same_v<Spec, last_frame>;
template <unsigned Percent>
inline constexpr bool changes_nothing_in_streams<dropout<Percent>> = true;
template <class... Specs>
inline constexpr bool changes_nothing_in_streams<sequence<Specs...>> =
    (changes_nothing_in_streams<tactnet::without_name<Specs>> && ...);

/// Whether a layer looks back to frames before the present one.
template <class Spec>
inline constexpr bool remembers_frames = false;
template <class Cell, std::size_t Hidden>
inline constexpr bool remembers_frames<recurrent<Cell, Hidden>> = true;
template <std::size_t Filters, std::size_t Taps, std::size_t Dilation>
inline constexpr bool remembers_frames<causal_conv1d<Filters, Taps, Dilation>> = Taps > 1;
template <class Main, class Skip>
inline constexpr bool remembers_frames<residual<Main, Skip>> =
    remembers_frames<tactnet::as_sequence<Main>> || remembers_frames<tactnet::as_sequence<Skip>>;
template <class... Specs>
inline constexpr bool remembers_frames<sequence<Specs...>> =
    (remembers_frames<tactnet::without_name<Specs>> || ...);

/// Whether a layer is `last_frame`, or a list or a residual block with it.
template <class Spec>
inline constexpr bool takes_last_frame = std::is_same_v<Spec, last_frame>;
template <class Main, class Skip>
inline constexpr bool takes_last_frame<residual<Main, Skip>> =
    takes_last_frame<tactnet::as_sequence<Main>> || takes_last_frame<tactnet::as_sequence<Skip>>;
template <class... Specs>
inline constexpr bool takes_last_frame<sequence<Specs...>> =
    (takes_last_frame<tactnet::without_name<Specs>> || ...);

/// A layer with the ReLU after it, in one step, in formats where this saves something.
template <class Spec>
struct rectified {
    static constexpr layer_costs costs(const shape& input) { return Spec::costs(input); }
};

} // namespace detail

template <class Cell, std::size_t Hidden, shape Input>
struct stream_lowering<recurrent<Cell, Hidden>, Input> {
    using step = recurrent_stream_step<single_precision, Cell, Input.channels, Hidden>;
};
template <std::size_t Filters, std::size_t Taps, std::size_t Dilation, shape Input>
struct stream_lowering<causal_conv1d<Filters, Taps, Dilation>, Input> {
    using step = causal_stream_step<single_precision, Input.channels, Filters, Taps, Dilation>;
};
/// A dense layer after `last_frame`.
template <std::size_t Outputs, shape Input>
    requires(Input.area() == 1)
struct stream_lowering<dense<Outputs>, Input> {
    using step = causal_stream_step<single_precision, Input.channels, Outputs, 1, 1>;
};
template <class Function, shape Input>
struct stream_lowering<activation<Function>, Input> {
    using step = activation_stream_step<single_precision, Function, Input.channels>;
};
template <class Main, class Skip, shape Input>
struct stream_lowering<residual<Main, Skip>, Input> {
    using step =
        residual_stream_step<single_precision, typename stream_lowering<as_sequence<Main>, Input>::step,
                             typename stream_lowering<as_sequence<Skip>, Input>::step>;
};

namespace detail {

/// The format of a step of a list in such a format. The last step writes what the list writes.
template <class Format, bool Last>
struct format_of_stream_step {
    using type = Format;
};
/// The format of the list of steps after one that writes `Number`s.
template <class Format, class Number>
struct format_after_stream_step {
    using type = Format;
};

/// Rejects a layer that does not run frame by frame, and replaces it by the identity, so that no further
/// errors follow.
template <class Spec, shape Input, class Format>
auto check_stream_step() {
    if constexpr (std::is_same_v<Format, single_precision>)
        static_assert(
            runs_in_streams<Spec, Input, Format>,
            "deploy_stream: this layer does not run frame by frame; runs_in_streams shows it and its "
            "input. Dense layers come after last_frame; for each frame, use causal_conv1d<outputs, 1>");
    else
        static_assert(
            runs_in_streams<Spec, Input, Format>,
            "deploy_stream: in 8 bits this layer does not run frame by frame here; runs_in_streams "
            "shows it, its input and the format of numbers. The first layer reads words of 16 bits: it "
            "must be gru, lstm, causal_conv1d or dense. Dense layers come after last_frame");
    return std::type_identity<copying_stream_step<typename Format::hidden_format, Input.channels>>{};
}
template <class Spec, shape Input, class Format>
struct checked_stream_step {
    using step = typename decltype(check_stream_step<Spec, Input, Format>())::type;
};
template <class Spec, shape Input, class Format>
    requires runs_in_streams<Spec, Input, Format>
struct checked_stream_step<Spec, Input, Format> : stream_lowering<Spec, Input, Format> {};

/// Rejects a list with memory after the last frame of a sequence: a stream has no end.
template <class Spec, class... Rest>
struct checked_stream_order {
    static_assert(!(takes_last_frame<Spec> && (remembers_frames<Rest> || ...)),
                  "deploy_stream: after last_frame, layers have one frame of each sequence: gru, lstm and "
                  "causal_conv1d of several taps must come before it");
};

/// The steps of a list, after those of the layers before. An empty list is the identity.
template <class Format, shape Input, class Before, class... Specs>
struct stream_list;
template <class Format, shape Input>
struct stream_list<Format, Input, stream_chain<>> {
    using step = stream_chain<copying_stream_step<Format, Input.channels>>;
};
template <class Format, shape Input, class... Before>
struct stream_list<Format, Input, stream_chain<Before...>> {
    using step = stream_chain<Before...>;
};
/// A layer, and the list of the others.
template <class Format, shape Input, class Before, class Spec, class... Rest>
struct stream_list_from;
template <class Format, shape Input, class... Before, class Spec, class... Rest>
struct stream_list_from<Format, Input, stream_chain<Before...>, Spec, Rest...>
    : checked_stream_order<Spec, Rest...> {
    static constexpr bool last = (changes_nothing_in_streams<Rest> && ...);
    using here =
        typename checked_stream_step<Spec, Input, typename format_of_stream_step<Format, last>::type>::step;
    using after = typename format_after_stream_step<Format, typename here::output_number>::type;
    using step =
        typename stream_list<after, Spec::costs(Input).output, stream_chain<Before..., here>, Rest...>::step;
};
template <class Format, shape Input, class Before, class Spec, class... Rest>
struct stream_list<Format, Input, Before, Spec, Rest...>
    : stream_list_from<Format, Input, Before, Spec, Rest...> {};
template <class Format, shape Input, class Before, class Spec, class... Rest>
    requires(changes_nothing_in_streams<Spec>)
struct stream_list<Format, Input, Before, Spec, Rest...>
    : stream_list<Format, Spec::costs(Input).output, Before, Rest...>, checked_stream_order<Spec, Rest...> {};
template <class Format, shape Input, class Before, class Spec, class Function, class... Rest>
    requires(is_relu<Function>() && runs_in_streams<rectified<Spec>, Input, Format>)
struct stream_list<Format, Input, Before, Spec, activation<Function>, Rest...>
    : stream_list_from<Format, Input, Before, rectified<Spec>, Rest...> {};

} // namespace detail

/// A list, whatever the names of its layers.
template <class... Specs, shape Input, class Format>
struct stream_lowering<sequence<Specs...>, Input, Format> {
    using step = typename detail::stream_list<Format, Input, stream_chain<>, without_name<Specs>...>::step;
};

}} // namespace tactnet
