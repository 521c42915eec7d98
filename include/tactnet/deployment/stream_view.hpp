#pragma once

#include <tactnet/deployment/frame_ref.hpp>
#include <tactnet/deployment/packed_steps.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/networks/recognition.hpp>
#include <tactnet/operators/sequence/step.hpp>
#include <tactnet/runtime/saved_state.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>

// The state of a stream as bytes that outlive the program. Nothing here uses the heap or throws.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Calls visit(number, most) for each number of a stream's state, in order; none has a larger magnitude. That
/// of recurrent layers is the bound of deployed_stream (recurrent_step::output_bound).
template <class State, class Visit>
void visit_stream_state(State& state, const Visit& visit) noexcept {
    if constexpr (requires { state.elements; }) {
        constexpr bool ring = requires { state.next; };
        for (auto& element : state.elements)
            visit(element, ring ? double{std::numeric_limits<float>::max()} : 0x1p24);
        if constexpr (ring)
            visit(state.next, static_cast<double>(State::frames - 1));
    } else {
        State::visit_states(state, [&](auto& inner) { visit_stream_state(inner, visit); });
    }
}
template <class State>
[[nodiscard]] constexpr std::size_t stream_state_numbers() {
    if constexpr (requires(State state) { state.next; })
        return sizeof(State::elements) + sizeof(State::next);
    else if constexpr (requires(State state) { state.elements; })
        return sizeof(State::elements);
    std::size_t bytes = 0;
    if constexpr (!requires(State state) { state.elements; }) {
        State state{};
        State::visit_states(state, [&]<class Inner>(Inner&) { bytes += stream_state_numbers<Inner>(); });
    }
    return bytes;
}
template <class State>
inline constexpr state_header stream_state_header{
    .kind = {'s', 't', 'r', 'm'}, .sizes = {static_cast<std::uint32_t>(stream_state_numbers<State>()), 0}};

} // namespace detail

/// The bytes of a saved state of a stream.
template <class State>
inline constexpr std::size_t saved_state_bytes =
    detail::state_header_bytes + detail::stream_state_numbers<State>() + detail::state_checksum_bytes;

/// Writes the state of a stream, with a checksum. It continues with the same network, compiled for the same
/// instruction set:
///
///     std::array<std::byte, tactnet::saved_state_bytes<stream::state>> bytes;
///     tactnet::save_state(memory, std::span(bytes));
///     …
///     if (tactnet::restore_state(bytes, memory) != tactnet::restore_status::ok) // memory is unchanged
template <class State>
void save_state(const State& state, std::span<std::byte, saved_state_bytes<State>> to) noexcept {
    detail::state_writer writer(to, detail::stream_state_header<State>);
    detail::visit_stream_state(state, [&](auto number, double) { writer.put(number); });
    writer.finish();
}

/// Takes what save_state wrote, in place of a state. Unless the result is ok, nothing changes: for damaged
/// bytes, and for numbers that no state has (not finite, or a place beyond a ring of frames).
template <class State>
[[nodiscard]] restore_status restore_state(std::span<const std::byte> from, State& state) noexcept {
    return detail::restore_numbers(from, saved_state_bytes<State>, detail::stream_state_header<State>,
                                   [&](const auto& visit) { detail::visit_stream_state(state, visit); });
}

// The part of streams that works without files, exceptions and run-time type information.

/// The only folded number is the largest magnitude of a feature for which no sum can leave the range of
/// single precision.
template <std::size_t Features>
struct stream_input_stage<single_precision, Features> {
    static constexpr std::size_t folded_elements = 1, packed_elements = pad_to_cache_line(1);
    static constexpr std::size_t map = pad_to_cache_line(Features);

    static constexpr void pack(const float* folded, float* packed) { *packed = *folded; }
    /// Whether all features are finite and small enough.
    static bool read(const float* packed, std::span<const float, Features> frame, float* in) noexcept {
        std::size_t out_of_range = 0;
        for (std::size_t f = 0; f < Features; ++f) {
            in[f] = frame[f];
            out_of_range += !(std::abs(frame[f]) <= *packed);
        }
        return out_of_range == 0;
    }
};

/// A stream over packed weights that a `deployed_stream` or a constant of the program keeps. Copies are
/// cheap. A call reads and writes nothing but its arguments, so any number of threads and recordings share
/// it, each with a state of its own. It uses no heap, no exceptions and no branch on the instruction set.
///
/// `Steps` is a step_chain for frames of so many features.
template <std::size_t Features, class Steps>
class stream_view : public detail::packed_steps<stream_input_stage<typename Steps::format, Features>, Steps> {
    using base = detail::packed_steps<stream_input_stage<typename Steps::format, Features>, Steps>;
    using typename base::packed_number, typename base::input;

public:
    using base::outputs; ///< numbers after each frame
    using typename base::activation, typename base::packed_weights;
    static constexpr std::size_t features = Features; ///< numbers of a frame
    static constexpr shape input_shape{1, 1, Features};

    /// What the stream remembers from frame to frame, as a plain struct. `state{}` is the beginning of a
    /// recording; a copy is a point to return to, and save_state writes it (stream_state.hpp).
    using state = detail::states_of_steps<std::index_sequence<0>, Steps>;
    static constexpr std::size_t state_bytes = sizeof(state);

    /// `packed` must outlive the view and be aligned to `vector_alignment`. Only the first `classes` outputs
    /// stand for a class.
    constexpr explicit stream_view(const packed_number* packed, std::size_t classes = outputs) noexcept
        : base(packed, classes) {}
    constexpr explicit stream_view(const packed_weights& weights, std::size_t classes = outputs) noexcept
        : stream_view(weights.elements.data(), classes) {}
    explicit stream_view(const packed_weights&&,
                         std::size_t = outputs) = delete; // they must outlive the view

    /// Takes the features of one frame, writes the outputs after it and updates the state. For a frame that
    /// the stream refuses (deployed_stream), returns not_finite; the state and the outputs are then
    /// unchanged, as if there had been no such frame.
    frame_status step(std::span<const float, features> frame, state& memory,
                      std::span<float, outputs> to) const noexcept {
        alignas(vector_alignment) std::array<activation, base::workspace_elements> elements;
        // Products of bytes read four at once, of which vectors write all.
        if constexpr (sizeof(activation) == 1 && kernels::min_lanes<float> == 1)
            elements.fill(0);
        activation* const out = elements.data() + input::map;
        if (!input::read(this->packed_, frame, elements.data()))
            return frame_status::not_finite;
        detail::run_step<0, Steps>(this->packed_ + input::packed_elements, elements.data(), out,
                                   out + base::output_map, memory);
        std::copy_n(reinterpret_cast<const float*>(out), outputs, to.data());
        return frame_status::ok;
    }
    /// As `step`, and returns the class that the outputs name: the largest logit, and its probability by a
    /// softmax. std::nullopt for a broken frame, which leaves the state unchanged.
    [[nodiscard]] std::optional<recognition> classify(std::span<const float, features> frame,
                                                      state& memory) const noexcept {
        std::array<float, outputs> found;
        return step(frame, memory, found) == frame_status::ok ? classify_logits(found, this->class_count())
                                                              : std::nullopt;
    }
    /// Takes a recording, `features` numbers of one frame after the other, and writes `outputs` numbers for
    /// each frame: the bits of a `step` for each. Returns the number of frames that were taken: all that are
    /// whole in both spans, or those before the first broken one, where the state stays.
    [[nodiscard]] std::size_t run(std::span<const float> recording, state& memory,
                                  std::span<float> to) const noexcept {
        const std::size_t frames = std::min(recording.size() / features, to.size() / outputs);
        for (std::size_t i = 0; i < frames; ++i)
            if (step(recording.subspan(i * features).template first<features>(), memory,
                     to.subspan(i * outputs).template first<outputs>()) != frame_status::ok)
                return i;
        return frames;
    }
};

}} // namespace tactnet
