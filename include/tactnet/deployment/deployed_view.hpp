#pragma once

#include <tactnet/deployment/frame.hpp>
#include <tactnet/deployment/frame_status.hpp>
#include <tactnet/deployment/refused_call.hpp>
#include <tactnet/deployment/steps.hpp>
#include <tactnet/tensor/tensor_view.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

// The part of deployment that a target without files, exceptions and run-time type information needs.

namespace tactnet {
inline namespace TACTNET_ARCH {

template <std::size_t Needed, std::size_t AtMost>
concept fits_stack = (Needed <= AtMost);

/// The fastest form of a trained network, over packed weights that someone else keeps (in a `deployed`, or in
/// a constant of the program). Copies are cheap. A call reads and writes nothing but its arguments: as many
/// threads as one likes may call the same object. No heap, no exceptions, no branch on the instruction set.
///
/// `Steps` is a step_chain whose input lies pixel by pixel without gaps.
template <shape Input, class Steps>
class deployed_view : detail::refused_calls<Input, Steps::output.size()> {
    static_assert(
        detail::fills_map<Steps>,
        "deployed_view: the last step writes among the channels of a wider map, which nobody reads");
    using format = typename Steps::format;
    using packed_number = typename format::packed;
    using input = input_stage<format, Input>;
    using exit = output_stage<format, Steps::output, Steps::output_stride>;
    static constexpr std::size_t output_elements = exit::map;

public:
    using steps = Steps;
    using activation = typename format::activation; ///< what maps between layers hold
    static constexpr shape input_shape = Input, output_shape = Steps::output;
    static constexpr std::size_t outputs = output_shape.size();

    /// The mean image, the scale of the input and its largest magnitude (see `not_finite`), then what remains
    /// of the parameters once batch norms are folded in: the same on every machine.
    static constexpr std::size_t steps_folded = input::folded, folded_elements = steps_folded + Steps::folded;
    /// The same in the order of use, for one instruction set.
    static constexpr std::size_t packed_elements = input::packed + Steps::packed;
    static constexpr std::size_t weight_bytes = packed_elements * sizeof(packed_number);

    /// Memory for one call, on the stack or wherever the caller likes. Nothing in it outlives the call.
    struct workspace {
        alignas(alignment)
            std::array<activation, input::map + output_elements + Steps::workspace_elements> elements;
    };
    static constexpr std::size_t workspace_bytes = sizeof(workspace);
    /// Networks that need more take their memory from the caller: stacks end at a few megabytes.
    static constexpr std::size_t most_on_stack = std::size_t{1} << 20;
    /// Elements of memory for each of the frames or threads, whichever are more, that pass together.
    static constexpr std::size_t workspace_elements =
        input::map + output_elements + Steps::workspace_elements;
    /// Whether frames had better pass together, and one frame occupy all threads.
    static constexpr bool large = Steps::large;

    /// Packed weights as a value, for constants of a program.
    struct packed_weights {
        alignas(alignment) std::array<packed_number, packed_elements> elements{};
    };
    /// `folded` holds folded_elements numbers, `packed` packed_elements zeros. Usable when compiling.
    static constexpr void pack(const float* folded, packed_number* packed) {
        input::pack(folded, packed);
        Steps::pack(folded + input::folded, packed + input::packed);
    }
    [[nodiscard]] static constexpr packed_weights pack(const std::array<float, folded_elements>& folded) {
        packed_weights result;
        pack(folded.data(), result.elements.data());
        return result;
    }

    /// Weights that outlive the view, aligned to `alignment`.
    constexpr explicit deployed_view(const packed_number* packed) noexcept : packed_(packed) {}
    constexpr explicit deployed_view(const packed_weights& weights) noexcept
        : packed_(weights.elements.data()) {}

    using detail::refused_calls<Input, outputs>::operator();
    /// Outputs of a frame of counts as the sensor gives them, or of numbers that are not whole, as after
    /// filtering: [row][column], for several channels one after the other. `to` gets what the trained network
    /// gives, logits or whatever its last layer makes.
    frame_status operator()(tensor_view<const std::uint8_t, Input> counts, std::span<float, outputs> to,
                            workspace& memory) const noexcept {
        return recognise(counts.data(), to, memory);
    }
    frame_status operator()(tensor_view<const float, Input> counts, std::span<float, outputs> to,
                            workspace& memory) const noexcept {
        return recognise(counts.data(), to, memory);
    }
    /// With workspace on the stack: workspace_bytes of it, up to `most_on_stack`.
    frame_status operator()(tensor_view<const std::uint8_t, Input> counts,
                            std::span<float, outputs> to) const noexcept {
        return on_stack(counts.data(), to);
    }
    frame_status operator()(tensor_view<const float, Input> counts,
                            std::span<float, outputs> to) const noexcept {
        return on_stack(counts.data(), to);
    }
    /// Frames and outputs one behind the other, on all threads of the executor
    /// (deployment/steps/batch_executor.hpp); `memory` holds workspace_elements for each of
    /// executor.copies(). The same bits as frame by frame.
    template <class Count, class Executor>
    frame_status infer_batch(const Count* counts, float* to, activation* memory,
                             const Executor& executor) const {
        activation* const in = memory;
        activation* const out = in + executor.copies() * input::map;
        std::atomic<bool> usual = true;
        executor.for_each_frame([&](std::size_t frame) {
            if (!input::read(packed_, counts + frame * Input.size(), in + frame * input::map))
                usual = false;
        });
        Steps::run_batch(packed_ + input::packed, in, input::map, out,
                         out + executor.copies() * output_elements, executor);
        executor.for_each_frame([&](std::size_t frame) {
            if (!exit::write(out + frame * output_elements,
                             std::span<float, outputs>(to + frame * outputs, outputs)))
                usual = false;
        });
        return usual ? frame_status::ok : frame_status::not_finite;
    }

private:
    template <class Count>
    frame_status on_stack(const Count* counts, std::span<float, outputs> to) const noexcept {
        static_assert(fits_stack<workspace_bytes, most_on_stack>,
                      "deployed: this network needs more workspace than a stack should hold: give it some "
                      "from the heap; fits_stack shows bytes needed, bytes at most");
        workspace memory;
        return recognise(counts, to, memory);
    }
    template <class Count>
    frame_status recognise(const Count* counts, std::span<float, outputs> to,
                           workspace& memory) const noexcept {
        activation* const in = memory.elements.data();
        activation* const out = in + input::map;
        const bool usual = input::read(packed_, counts, in);
        Steps::run(packed_ + input::packed, in, out, out + output_elements);
        return exit::write(out, to) && usual ? frame_status::ok : frame_status::not_finite;
    }

    const packed_number* packed_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
