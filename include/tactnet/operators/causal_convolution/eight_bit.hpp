#pragma once

#include <tactnet/operators/activations/function.hpp>
#include <tactnet/operators/causal_convolution/step.hpp>
#include <tactnet/operators/convolution/eight_bit.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Elements from one frame to the next, of so many features: products take four bytes at once.
[[nodiscard]] constexpr std::size_t frame_stride(std::size_t features) {
    return round_up(features, 4);
}
/// A product in 8 bits with `Frames` frames: a convolution with one output.
template <class Format, std::size_t Frames, std::size_t Features, std::size_t Outputs, bool Rectified = false>
using frames_product =
    convolution_step<Format, kernels::frame_convolution{.window = {{Frames, 1, Features}, {Frames, 1}, 1},
                                                        .filters = Outputs,
                                                        .input_stride = frame_stride(Features),
                                                        .activation = Rectified ? fused<relu_function>
                                                                                : &kernels::no_activation}>;

} // namespace detail

template <class In, class Out, std::size_t Features, std::size_t Filters, std::size_t Taps,
          std::size_t Dilation, bool Rectified>
struct causal_step<eight_bit_between<In, Out>, Features, Filters, Taps, Dilation, Rectified>
    : detail::frames_product<eight_bit_between<In, Out>, Taps, Features, Filters, Rectified>,
      detail::looks_back<In, Features, Taps, Dilation> {
private:
    using product = detail::frames_product<eight_bit_between<In, Out>, Taps, Features, Filters, Rectified>;
    static constexpr std::size_t stride = detail::frame_stride(Features);
    static_assert(Dilation > 0);

public:
    // The product's, then the zero of its input. The numbers of the state are those of frames less that zero.
    static constexpr std::size_t packed_elements =
        product::packed_elements + (Taps > 1 ? pad_to_cache_line<std::int8_t>(1) : 0);

    static constexpr void pack(const float* folded, std::int8_t* packed) {
        product::pack(folded, packed);
        if constexpr (Taps > 1)
            detail::store_byte(packed + product::packed_elements,
                               static_cast<double>(product::arrays.read_ranges(folded).input.zero_point));
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        product::run(packed, in, out, memory);
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t* memory, auto& state) noexcept {
        const int zero = detail::load_byte(packed + product::packed_elements);
        alignas(vector_alignment) std::array<In, pad_to_cache_line<In>(Taps * stride)> inputs{};
        for (std::size_t tap = 0; tap + 1 < Taps; ++tap)
            for (std::size_t f = 0; f < Features; ++f)
                inputs[tap * stride + f] = static_cast<In>(state.before(tap)[f] + zero);
        const auto* const present = reinterpret_cast<const In*>(in);
        std::copy_n(present, Features, inputs.data() + (Taps - 1) * stride);
        In* const kept = state.replace_oldest();
        for (std::size_t f = 0; f < Features; ++f)
            kept[f] = static_cast<In>(present[f] - zero);
        product::run(packed, reinterpret_cast<const std::uint8_t*>(inputs.data()), out, memory);
    }
};

}} // namespace tactnet
