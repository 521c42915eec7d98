#pragma once

#include <tactnet/deployment/stream_state.hpp>
#include <tactnet/deployment/streaming/chain.hpp>
#include <tactnet/deployment/streaming/single_precision.hpp>
#include <tactnet/deployment/streaming/stream_calls.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

// The part of streams that works without files, exceptions and run-time type information.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Reads the features of a frame into the map of the first step. Its folded numbers come before those of the
/// steps. Specialised for each number format.
template <class Format, std::size_t Features>
struct stream_input;
/// Writes the map of the last step, `Number`s, as outputs. Its folded numbers come after those of the steps.
template <class Format, class Number, std::size_t Outputs>
struct stream_output;

/// The only folded number is the largest magnitude of a feature for which no sum can leave the range of
/// single precision.
template <std::size_t Features>
struct stream_input<single_precision, Features> {
    static constexpr std::size_t folded_elements = 1, packed_elements = pad_to_cache_line(1);
    static constexpr std::size_t map_elements = kernels::padded_size<float>(Features);

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
template <std::size_t Outputs>
struct stream_output<single_precision, float, Outputs> {
    static constexpr std::size_t folded_elements = 0, packed_elements = 0;

    static constexpr void pack(const float*, float*) {}
    static void write(const float*, const float* out, std::span<float, Outputs> to) noexcept {
        std::copy_n(out, Outputs, to.data());
    }
};

/// A stream over packed weights that a `deployed_stream` or a constant of the program keeps. Copies are
/// cheap. A call reads and writes nothing but its arguments, so any number of threads and recordings share
/// it, each with a state of its own. It uses no heap, no exceptions and no branch on the instruction set.
///
/// `Steps` is a stream_chain.
template <class Steps>
class stream_view : public detail::stream_calls<stream_view<Steps>, Steps::features, Steps::outputs> {
    using calls = detail::stream_calls<stream_view, Steps::features, Steps::outputs>;
    using format = typename Steps::format;
    using element = typename Steps::element;
    using packed_number = typename format::packed_number;
    using input = stream_input<format, Steps::features>;
    using output = stream_output<format, typename Steps::output_number, Steps::outputs>;

public:
    using calls::features;
    using calls::outputs;
    using steps = Steps;
    /// What the stream remembers from frame to frame, as a plain struct. `state{}` is the beginning of a
    /// recording; a copy is a point to return to, and save_state writes it (stream_state.hpp).
    using state = typename Steps::state;
    static constexpr std::size_t state_bytes = sizeof(state);

    /// Folded numbers are those of the input, of the steps and of the outputs. They are the same on every
    /// machine.
    static constexpr std::size_t folded_elements =
        input::folded_elements + Steps::folded_elements + output::folded_elements;
    /// Packed weights are the folded numbers in the order of use, for one instruction set.
    static constexpr std::size_t packed_elements =
        input::packed_elements + Steps::packed_elements + output::packed_elements;
    static constexpr std::size_t weight_bytes = packed_elements * sizeof(packed_number);

    /// Packed weights as a value, for a constant of a program.
    struct packed_weights {
        alignas(vector_alignment) std::array<packed_number, packed_elements> elements{};
    };
    /// Packs folded_elements numbers. `packed` holds packed_elements zeros.
    static constexpr void pack(const float* folded, packed_number* packed) {
        input::pack(folded, packed);
        Steps::pack(folded + input::folded_elements, packed + input::packed_elements);
        output::pack(folded + input::folded_elements + Steps::folded_elements,
                     packed + input::packed_elements + Steps::packed_elements);
    }
    [[nodiscard]] static constexpr packed_weights pack(const std::array<float, folded_elements>& folded) {
        packed_weights result;
        pack(folded.data(), result.elements.data());
        return result;
    }

    /// `packed` must outlive the view and be aligned to `vector_alignment`. Only the first `classes` outputs
    /// stand for a class.
    constexpr explicit stream_view(const packed_number* packed, std::size_t classes = outputs) noexcept
        : packed_(packed), classes_(classes) {}
    constexpr explicit stream_view(const packed_weights& weights, std::size_t classes = outputs) noexcept
        : stream_view(weights.elements.data(), classes) {}
    explicit stream_view(const packed_weights&&,
                         std::size_t = outputs) = delete; // they must outlive the view

    [[nodiscard]] constexpr std::size_t class_count() const noexcept { return classes_; }

    /// Takes the features of one frame, writes the outputs after it and updates the state. For a frame that
    /// the input refuses (deployed_stream), returns not_finite; the state and the outputs are then unchanged,
    /// as if there had been no such frame.
    frame_status step(std::span<const float, features> frame, state& memory,
                      std::span<float, outputs> to) const noexcept {
        alignas(vector_alignment) std::array<element, input::map_elements> in{};
        if (!input::read(packed_, frame, in.data()))
            return frame_status::not_finite;
        alignas(vector_alignment) std::array<element, Steps::map_elements> out{};
        alignas(vector_alignment) std::array<element, pad_to_cache_line(Steps::workspace_elements + 1)>
            workspace;
        const packed_number* const of_steps = packed_ + input::packed_elements;
        Steps::run(of_steps, in.data(), memory, out.data(), workspace.data());
        output::write(of_steps + Steps::packed_elements, out.data(), to);
        return frame_status::ok;
    }

private:
    const packed_number* packed_;
    std::size_t classes_;
};

}} // namespace tactnet
