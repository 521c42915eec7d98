#pragma once

#include <tactnet/deployment/step_chain.hpp>
#include <tactnet/tensor/tensor_view.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

// The part of deployment that a target without files, exceptions and run-time type information needs.

namespace tactnet::inline TACTNET_ARCH {

/// What became of a frame.
enum class frame_status {
    recognised,
    not_finite ///< NaN or infinity in the frame, or numbers beyond single precision on the way: the outputs
               ///< mean nothing
};

/// The fastest form of a trained network, over packed weights that someone else keeps (in a `deployed`, or in
/// a constant of the program). Copies are cheap. A call reads and writes nothing but its arguments: as many
/// threads as one likes may call the same object. No heap, no exceptions, no branch on the instruction set.
///
/// `Steps` is a step_chain whose input lies pixel by pixel without gaps.
template <shape Input, class Steps>
class deployed_view {
    static constexpr std::size_t mean_elements = detail::whole_lines(Input.size());
    static constexpr std::size_t steps_begin = mean_elements + detail::whole_lines(1);
    static constexpr std::size_t output_elements =
        detail::whole_lines(Steps::output.area() * Steps::output_stride);

public:
    using steps = Steps;
    static constexpr shape input_shape = Input, output_shape = Steps::output;
    static constexpr std::size_t outputs = output_shape.size();

    /// The mean image and the scale of the input, then what remains of the parameters once batch norms are
    /// folded in: the same on every machine.
    static constexpr std::size_t folded_elements = Input.size() + 1 + Steps::folded;
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
    /// `folded` holds folded_elements numbers, `packed` packed_elements zeros. Usable when compiling.
    static constexpr void pack(const float* folded, float* packed) {
        std::copy_n(folded, Input.size(), packed);
        packed[mean_elements] = folded[Input.size()];
        Steps::pack(folded + Input.size() + 1, packed + steps_begin);
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
        // Pools and ReLUs let a NaN vanish: it must be seen here. A finite number times zero is zero.
        float broken = 0;
        if constexpr (std::is_floating_point_v<Count>)
            broken = sum_of_zeros(in, Input.size());
        Steps::run(packed_ + steps_begin, in, out, out + output_elements);
        for (std::size_t channel = 0; channel < output_shape.channels; ++channel)
            for (std::size_t pixel = 0; pixel < output_shape.area(); ++pixel)
                to[channel * output_shape.area() + pixel] = out[pixel * Steps::output_stride + channel];
        broken += sum_of_zeros(to.data(), outputs);
        return broken == 0 ? frame_status::recognised : frame_status::not_finite;
    }
    /// Zero, or NaN if any element is NaN or infinite. In lanes, or each addition would wait for the last.
    static float sum_of_zeros(const float* values, std::size_t count) {
        constexpr std::size_t chains = 32;
        std::array<float, chains> sums{};
        std::size_t i = 0;
        for (; i + chains <= count; i += chains)
            for (std::size_t lane = 0; lane < chains; ++lane)
                sums[lane] += values[i + lane] * 0;
        for (; i < count; ++i)
            sums[0] += values[i] * 0;
        float sum = 0;
        for (const float s : sums)
            sum += s;
        return sum;
    }

    const float* packed_;
};

} // namespace tactnet
