#pragma once

#include <tactnet/deployment/eight_bit/streaming/frame_step.hpp>
#include <tactnet/lowering/frame_ring.hpp>

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
    static constexpr std::size_t stride = detail::frame_stride(Features);
    static_assert(Dilation > 0);

public:
    // The product's, then the zero of its input.
    static constexpr std::size_t packed_elements =
        product::packed_elements + pad_to_cache_line<std::int8_t>(1);

    /// Its numbers are those of the frames less the zero of their range.
    using state = detail::frame_ring<In, Features, Taps, Dilation>;

    static constexpr void pack(const float* folded, std::int8_t* packed) {
        product::pack(folded, packed);
        detail::store_byte(packed + product::packed_elements,
                           static_cast<double>(product::arrays.read_ranges(folded).input.zero_point));
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, state& s, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        const int zero = detail::load_byte(packed + product::packed_elements);
        alignas(vector_alignment) std::array<In, pad_to_cache_line<In>(Taps * stride)> inputs{};
        for (std::size_t tap = 0; tap + 1 < Taps; ++tap)
            for (std::size_t f = 0; f < Features; ++f)
                inputs[tap * stride + f] = static_cast<In>(s.before(tap)[f] + zero);
        const auto* const present = reinterpret_cast<const In*>(in);
        std::copy_n(present, Features, inputs.data() + (Taps - 1) * stride);
        In* const kept = s.replace_oldest();
        for (std::size_t f = 0; f < Features; ++f)
            kept[f] = static_cast<In>(present[f] - zero);
        product::run(packed, reinterpret_cast<const std::uint8_t*>(inputs.data()), out, memory);
    }
};

}} // namespace tactnet
