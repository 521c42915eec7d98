#pragma once

#include <tactnet/kernels/frame/direct.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

// Depthwise convolution of one frame: each filter sees one channel, as in separable convolutions (MobileNet,
// Howard et al., 2017). A vector of channels meets the vector of their filters, so that each tap of each
// filter is one multiply-add. The register blocks are those of direct.hpp.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// As many groups as channels, with one filter each or several. Where pixels of the input do not hold the
/// channels of the filters in whole vectors, they are copied so first.
template <frame_convolution C>
struct depthwise_method : frame_method {
    static constexpr const char* name = "depthwise";
    static constexpr bool applicable = C.groups > 1 && C.groups == C.window.input.channels&& C.fits_map();
    static constexpr std::size_t filters_per_channel = C.filters / C.groups;
    /// Whether the input is copied: [pixel][filter], padded to whole vectors of filters.
    static constexpr bool copied = filters_per_channel > 1 || !C.input_in_vectors_of(C.width());
    static constexpr frame_convolution one_to_one = [] {
        frame_convolution c = C;
        c.window.input.channels = c.groups = C.filters;
        if (copied)
            c.input_stride = C.padded_filters(), c.input_offset_multiple = 0;
        return c;
    }();
    /// A number that is copied alone counts as half a multiply-add of a vector.
    static constexpr std::uint64_t cost =
        C.vector_products() * product + (copied ? C.window.input.area() * C.filters * product / 2 : 0);
    static constexpr std::size_t packed_weights = whole_lines(C.weights());
    static constexpr std::size_t packed_elements = packed_weights + whole_lines(C.padded_filters());
    static constexpr std::size_t workspace_elements =
        copied ? whole_lines(C.window.input.area() * C.padded_filters()) : 0;

    template <class Weight>
    static constexpr void pack(const Weight& weight, const float* biases, float* to) {
        pack_frame_weights<one_to_one>(weight, to);
        std::copy_n(biases, C.filters, to + packed_weights);
    }
    static void run(const float* packed, const float* in, float* out,
                    [[maybe_unused]] float* workspace) noexcept {
        if constexpr (copied) {
            float* to = workspace;
            for (std::size_t pixel = 0; pixel < C.window.input.area(); ++pixel, in += C.input_stride) {
                for (std::size_t channel = 0; channel < C.groups; ++channel, to += filters_per_channel)
                    std::fill_n(to, filters_per_channel, in[channel]);
                to = std::fill_n(to, C.padded_filters() - C.filters, 0.0f);
            }
            in = workspace;
        }
        convolve_frame<one_to_one>(in, packed, packed + packed_weights, out);
    }
};

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
