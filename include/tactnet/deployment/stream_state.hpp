#pragma once

#include <tactnet/runtime/saved_state.hpp>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

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

}} // namespace tactnet
