#pragma once

#include <tactnet/deployment/eight_bit/streaming/stream_step.hpp>
#include <tactnet/layers/time/causal_conv1d.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Causal convolutions, with a ReLU or without. They remember the frames that they look back to.
template <class Spec, bool Rectified, shape Input, class In, class Out>
struct causal_convolution_step
    : detail::frame_stream_step<
          detail::frames_product<In, Out, Spec::taps, Input.channels, Spec::filters, Rectified>,
          std::conditional_t<Rectified, stream_step<detail::rectified<Spec>, Input>,
                             stream_step<Spec, Input>>,
          Input.channels, Out, std::is_same_v<Out, std::uint8_t>> {
private:
    using product = detail::frames_product<In, Out, Spec::taps, Input.channels, Spec::filters, Rectified>;
    static constexpr std::size_t features = Input.channels, frames = Spec::frames_before,
                                 stride = detail::frame_stride(features);
    static_assert(Spec::dilation > 0);

public:
    // The product's, then the zero of its input.
    static constexpr std::size_t packed_elements =
        product::packed_elements + pad_to_cache_line<std::int8_t>(1);

    /// The numbers of the frames before the present one less the zero of their range, in a ring; `next` is
    /// the oldest.
    struct state {
        std::array<In, frames * features> elements{};
        std::uint32_t next = 0;
    };

    static void pack(const float* folded, std::int8_t* packed) {
        product::pack(folded, packed);
        detail::store_byte(packed + product::packed_elements,
                           static_cast<double>(product::arrays.read_ranges(folded).input.zero_point));
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, state& s, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        const int zero = detail::load_byte(packed + product::packed_elements);
        alignas(vector_alignment) std::array<In, pad_to_cache_line<In>(Spec::taps * stride)> inputs{};
        for (std::size_t tap = 0; tap + 1 < Spec::taps; ++tap) {
            // The frame (taps − 1 − tap) · dilation before the present one is this far after the oldest.
            std::size_t frame = s.next + tap * Spec::dilation;
            if (frame >= frames)
                frame -= frames;
            for (std::size_t f = 0; f < features; ++f)
                inputs[tap * stride + f] = static_cast<In>(s.elements[frame * features + f] + zero);
        }
        const auto* const present = reinterpret_cast<const In*>(in);
        std::copy_n(present, features, inputs.data() + (Spec::taps - 1) * stride);
        if constexpr (frames > 0) {
            for (std::size_t f = 0; f < features; ++f)
                s.elements[s.next * features + f] = static_cast<In>(present[f] - zero);
            s.next = s.next + 1 == frames ? 0 : s.next + 1;
        }
        product::run(packed, reinterpret_cast<const std::uint8_t*>(inputs.data()), out, memory);
    }
};

template <std::size_t Filters, std::size_t Taps, std::size_t Dilation, shape Input, class In, class Out>
struct stream_step<causal_conv1d<Filters, Taps, Dilation>, Input, eight_bit_between<In, Out>>
    : causal_convolution_step<causal_conv1d<Filters, Taps, Dilation>, false, Input, In, Out> {};
template <std::size_t Filters, std::size_t Taps, std::size_t Dilation, shape Input, class In, class Out>
struct stream_step<detail::rectified<causal_conv1d<Filters, Taps, Dilation>>, Input,
                   eight_bit_between<In, Out>>
    : causal_convolution_step<causal_conv1d<Filters, Taps, Dilation>, true, Input, In, Out> {};

}} // namespace tactnet
