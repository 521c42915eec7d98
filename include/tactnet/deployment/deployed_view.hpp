#pragma once

#include <tactnet/deployment/step_chain.hpp>
#include <tactnet/tensor/tensor_view.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <type_traits>

// The part of deployment that a target without files, exceptions and run-time type information needs.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// What became of a frame. Not to be ignored: outputs of a broken frame look like any others.
enum class [[nodiscard]] frame_status{
    recognised,
    not_finite ///< NaN or infinity in the frame or in the outputs, or a number so large that sums in the
               ///< network might leave the range of single precision: the outputs mean nothing
};

/// The fastest form of a trained network, over packed weights that someone else keeps (in a `deployed`, or in
/// a constant of the program). Copies are cheap. A call reads and writes nothing but its arguments: as many
/// threads as one likes may call the same object. No heap, no exceptions, no branch on the instruction set.
///
/// `Steps` is a step_chain whose input lies pixel by pixel without gaps.
template <shape Input, class Steps>
class deployed_view {
    static constexpr std::size_t mean_elements = whole_lines(Input.size());
    static constexpr std::size_t steps_begin = mean_elements + whole_lines(2);
    static constexpr std::size_t output_elements = whole_lines(Steps::output.area() * Steps::output_stride);

public:
    using steps = Steps;
    static constexpr shape input_shape = Input, output_shape = Steps::output;
    static constexpr std::size_t outputs = output_shape.size();

    /// The mean image, the scale of the input and its largest magnitude (see `not_finite`), then what remains
    /// of the parameters once batch norms are folded in: the same on every machine.
    static constexpr std::size_t steps_folded = Input.size() + 2,
                                 folded_elements = steps_folded + Steps::folded;
    /// The same in the order of use, for one instruction set.
    static constexpr std::size_t packed_elements = steps_begin + Steps::packed;
    static constexpr std::size_t weight_bytes = packed_elements * sizeof(float);

    /// Memory for one call, on the stack or wherever the caller likes. Nothing in it outlives the call.
    struct scratch {
        alignas(alignment) std::array<float, mean_elements + output_elements + Steps::scratch> elements;
    };
    static constexpr std::size_t scratch_bytes = sizeof(scratch);

    /// Packed weights as a value, for constants of a program.
    struct packed_weights {
        alignas(alignment) std::array<float, packed_elements> elements{};
    };
    /// `folded` holds folded_elements numbers, `packed` packed_elements zeros. Usable at compile time.
    static constexpr void pack(const float* folded, float* packed) {
        std::copy_n(folded, Input.size(), packed);
        packed[mean_elements] = folded[Input.size()];
        packed[mean_elements + 1] = folded[Input.size() + 1];
        Steps::pack(folded + steps_folded, packed + steps_begin);
    }
    [[nodiscard]] static constexpr packed_weights pack(const std::array<float, folded_elements>& folded) {
        packed_weights result;
        pack(folded.data(), result.elements.data());
        return result;
    }

    /// Weights that outlive the view, aligned to `alignment`.
    constexpr explicit deployed_view(const float* packed) noexcept : packed_(packed) {}
    constexpr explicit deployed_view(const packed_weights& weights) noexcept
        : packed_(weights.elements.data()) {}

    /// Outputs of a frame of counts as the sensor gives them, or of numbers that are not whole, as after
    /// filtering: [row][column], for several channels one after the other. `to` gets what the trained network
    /// gives, logits or whatever its last layer makes.
    frame_status operator()(tensor_view<const std::uint8_t, Input> counts, std::span<float, outputs> to,
                            scratch& memory) const noexcept {
        return recognise(counts.data(), to, memory);
    }
    frame_status operator()(tensor_view<const float, Input> counts, std::span<float, outputs> to,
                            scratch& memory) const noexcept {
        return recognise(counts.data(), to, memory);
    }
    /// With scratch memory on the stack: scratch_bytes of it.
    frame_status operator()(tensor_view<const std::uint8_t, Input> counts,
                            std::span<float, outputs> to) const noexcept {
        scratch memory;
        return recognise(counts.data(), to, memory);
    }
    frame_status operator()(tensor_view<const float, Input> counts,
                            std::span<float, outputs> to) const noexcept {
        scratch memory;
        return recognise(counts.data(), to, memory);
    }

private:
    template <class Count>
    frame_status recognise(const Count* counts, std::span<float, outputs> to,
                           scratch& memory) const noexcept {
        const float* const mean = packed_;
        const float scale = packed_[mean_elements];
        float* const in = memory.elements.data();
        float* const out = in + mean_elements;
        for (std::size_t channel = 0; channel < Input.channels; ++channel)
            for (std::size_t pixel = 0; pixel < Input.area(); ++pixel) {
                const std::size_t at = channel * Input.area() + pixel;
                in[pixel * Input.channels + channel] = (static_cast<float>(counts[at]) - mean[at]) * scale;
            }
        // Pools and ReLUs would let a NaN or an infinity vanish: it must be seen here. The limit is one
        // that counts of 8 bits keep.
        std::uint32_t beyond = 0;
        if constexpr (std::is_floating_point_v<Count>) {
            const float limit = packed_[mean_elements + 1];
            for (std::size_t e = 0; e < Input.size(); ++e)
                beyond += !(in[e] <= limit && in[e] >= -limit);
        }
        Steps::run(packed_ + steps_begin, in, out, out + output_elements);
        for (std::size_t channel = 0; channel < output_shape.channels; ++channel)
            for (std::size_t pixel = 0; pixel < output_shape.area(); ++pixel)
                to[channel * output_shape.area() + pixel] = out[pixel * Steps::output_stride + channel];
        for (const float value : to)
            beyond += !(std::abs(value) <= std::numeric_limits<float>::max());
        return beyond == 0 ? frame_status::recognised : frame_status::not_finite;
    }

    const float* packed_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
