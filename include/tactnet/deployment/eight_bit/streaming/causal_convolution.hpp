#pragma once

#include <tactnet/deployment/eight_bit/streaming/frame_step.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The product of a causal convolution with the frames that it looks back to.
template <class In, class Out, std::size_t Features, std::size_t Filters, std::size_t Taps,
          std::size_t Dilation, bool Rectified>
using causal_product_step =
    frame_stream_step<eight_bit_between<In, Out>,
                      causal_stream_step<single_precision, Features, Filters, Taps, Dilation, Rectified>, Out,
                      frames_product<In, Out, Taps, Features, Filters, Rectified>,
                      std::is_same_v<Out, std::uint8_t>>;

} // namespace detail

/// A dense layer.
template <class In, class Out, std::size_t Features, std::size_t Filters, std::size_t Dilation,
          bool Rectified>
struct causal_stream_step<eight_bit_between<In, Out>, Features, Filters, 1, Dilation, Rectified>
    : detail::causal_product_step<In, Out, Features, Filters, 1, Dilation, Rectified> {};

template <class In, class Out, std::size_t Features, std::size_t Filters, std::size_t Taps,
          std::size_t Dilation, bool Rectified>
struct causal_stream_step<eight_bit_between<In, Out>, Features, Filters, Taps, Dilation, Rectified>
    : detail::causal_product_step<In, Out, Features, Filters, Taps, Dilation, Rectified> {
private:
    using product = detail::frames_product<In, Out, Taps, Features, Filters, Rectified>;
    static constexpr std::size_t frames = (Taps - 1) * Dilation, stride = detail::frame_stride(Features);
    static_assert(Dilation > 0);

public:
    // The product's, then the zero of its input.
    static constexpr std::size_t packed_elements =
        product::packed_elements + pad_to_cache_line<std::int8_t>(1);

    /// The numbers of the frames before the present one less the zero of their range, in a ring; `next` is
    /// the oldest.
    struct state {
        std::array<In, frames * Features> elements{};
        std::uint32_t next = 0;
    };

    static constexpr void pack(const float* folded, std::int8_t* packed) {
        product::pack(folded, packed);
        detail::store_byte(packed + product::packed_elements,
                           static_cast<double>(product::arrays.read_ranges(folded).input.zero_point));
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, state& s, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        const int zero = detail::load_byte(packed + product::packed_elements);
        alignas(vector_alignment) std::array<In, pad_to_cache_line<In>(Taps * stride)> inputs{};
        for (std::size_t tap = 0; tap + 1 < Taps; ++tap) {
            // The frame (taps − 1 − tap) · dilation before the present one is this far after the oldest.
            std::size_t frame = s.next + tap * Dilation;
            if (frame >= frames)
                frame -= frames;
            for (std::size_t f = 0; f < Features; ++f)
                inputs[tap * stride + f] = static_cast<In>(s.elements[frame * Features + f] + zero);
        }
        const auto* const present = reinterpret_cast<const In*>(in);
        std::copy_n(present, Features, inputs.data() + (Taps - 1) * stride);
        if constexpr (frames > 0) {
            for (std::size_t f = 0; f < Features; ++f)
                s.elements[s.next * Features + f] = static_cast<In>(present[f] - zero);
            s.next = s.next + 1 == frames ? 0 : s.next + 1;
        }
        product::run(packed, reinterpret_cast<const std::uint8_t*>(inputs.data()), out, memory);
    }
};

}} // namespace tactnet
