#pragma once

#include <tactnet/deployment/frame_ref.hpp>
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
#include <optional>
#include <span>
#include <utility>

// The part of streams that works without files, exceptions and run-time type information.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Calls visit(number, most) for each number of a stream's state, in order; none has a larger magnitude. That
/// of recurrent layers is the bound of deployed_stream (recurrent_step::output_bound), and largest() is
/// called once for each state in order: the bound of those that hold inputs.
template <class State>
void visit_stream_state(State& state, const auto& visit, const auto& largest) noexcept {
    if constexpr (requires { state.elements; }) {
        constexpr bool ring = requires { state.next; };
        const double most = largest();
        for (auto& element : state.elements)
            visit(element, ring ? most : 0x1p24);
        if constexpr (ring)
            visit(state.next, static_cast<double>(State::frames - 1));
    } else {
        State::visit_states(state, [&](auto& inner) { visit_stream_state(inner, visit, largest); });
    }
}
/// How many states of steps it consists of, and the bytes of their numbers.
struct stream_state_extent {
    std::size_t states = 0, bytes = 0;
};
template <class State>
[[nodiscard]] constexpr stream_state_extent stream_state_size() {
    State state{};
    if constexpr (requires { state.next; })
        return {1, sizeof(State::elements) + sizeof(State::next)};
    else if constexpr (requires { state.elements; })
        return {1, sizeof(State::elements)};
    stream_state_extent sum;
    if constexpr (!requires { state.elements; })
        State::visit_states(state, [&]<class Inner>(Inner&) {
            const stream_state_extent inner = stream_state_size<Inner>();
            sum.states += inner.states, sum.bytes += inner.bytes;
        });
    return sum;
}
template <class State>
inline constexpr state_header stream_state_header{
    .kind = {'s', 't', 'r', 'm'}, .sizes = {static_cast<std::uint32_t>(stream_state_size<State>().bytes), 0}};

} // namespace detail

/// The bytes of a saved state of a stream.
template <class State>
inline constexpr std::size_t saved_state_bytes =
    detail::state_header_bytes + detail::stream_state_size<State>().bytes + detail::state_checksum_bytes;

/// Writes the state of a stream, with a checksum. It continues with the same network, compiled for the same
/// instruction set:
///
///     std::array<std::byte, tactnet::saved_state_bytes<stream::state>> bytes;
///     tactnet::save_state(memory, std::span(bytes));
///     …
///     if (network.restore_state(bytes, memory) != tactnet::restore_status::ok) // memory is unchanged
template <class State>
void save_state(const State& state, std::span<std::byte, saved_state_bytes<State>> to) noexcept {
    detail::state_writer writer(to, detail::stream_state_header<State>);
    detail::visit_stream_state(
        state, [&](auto number, double) { writer.put(number); }, [] { return 0.0; });
    writer.finish();
}

/// The folded numbers are the largest magnitude of a feature for which no sum can leave the range of single
/// precision, and that of the inputs that each state may hold.
template <std::size_t Features, std::size_t States>
struct stream_input_stage<single_precision, Features, States> {
    static constexpr std::size_t folded_elements = 1 + States,
                                 packed_elements = pad_to_cache_line(folded_elements);
    static constexpr std::size_t map = pad_to_cache_line(Features);

    static constexpr void pack(const float* folded, float* packed) {
        std::copy_n(folded, folded_elements, packed);
    }
    static double largest_in_state(const float* packed, std::size_t state) noexcept {
        return static_cast<double>(packed[1 + state]);
    }
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

namespace detail {

template <class Steps>
using state_of_stream = states_of_steps<std::index_sequence<0>, Steps>;
template <std::size_t Features, class Steps>
using stream_steps = packed_steps<
    stream_input_stage<typename Steps::format, Features, stream_state_size<state_of_stream<Steps>>().states>,
    Steps>;

} // namespace detail

/// A stream over packed weights that a `deployed_stream` or a constant of the program keeps. Copies are
/// cheap. A call reads and writes nothing but its arguments, so any number of threads and recordings share
/// it, each with a state of its own. It uses no heap, no exceptions and no branch on the instruction set.
///
/// `Steps` is a step_chain for frames of so many features.
template <std::size_t Features, class Steps>
class stream_view : public detail::stream_steps<Features, Steps> {
    using base = detail::stream_steps<Features, Steps>;
    using typename base::packed_number, typename base::input;

public:
    using base::outputs; ///< numbers after each frame
    using typename base::activation, typename base::packed_weights;
    static constexpr std::size_t features = Features; ///< numbers of a frame
    static constexpr shape input_shape{1, 1, Features};

    /// What the stream remembers from frame to frame, as a plain struct. `state{}` is the beginning of a
    /// recording; a copy is a point to return to, and save_state writes it.
    using state = detail::state_of_stream<Steps>;
    static constexpr std::size_t state_bytes = sizeof(state);

    using base::base;

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
        return step(frame, memory, found) == frame_status::ok
                   ? classify_logits(found, this->class_count(), this->temperature_)
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
    /// Reads what save_state wrote in place of a state. Unless the result is ok, nothing changes: for damaged
    /// bytes, and for numbers that no state of this stream has, with which outputs might not be finite.
    [[nodiscard]] restore_status restore_state(std::span<const std::byte> from,
                                               state& memory) const noexcept {
        return detail::restore_numbers(
            from, saved_state_bytes<state>, detail::stream_state_header<state>, [&](const auto& visit) {
                std::size_t next = 0;
                detail::visit_stream_state(memory, visit,
                                           [&] { return input::largest_in_state(this->packed_, next++); });
            });
    }
};

}} // namespace tactnet
