#pragma once

// A convolution with an activation function in its epilogue, compared with the function in a step of its own.

#include <tactnet/deployment.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <support/frame_convolution.hpp>
#include <support/same_bits.hpp>
#include <vector>

namespace support {

using tactnet::kernels::frame_convolution;

template <class Function>
constexpr frame_convolution with(frame_convolution c) {
    c.activation = tactnet::fused<Function>;
    return c;
}
/// With a max pool after it, before the function; `whole` leaves out windows that the image does not fill.
constexpr frame_convolution pooled_before(frame_convolution c, tactnet::extent2d pool, bool whole = false) {
    c = pooled(c, pool, whole);
    c.activation = &tactnet::kernels::no_activation;
    return c;
}
constexpr frame_convolution in_groups(frame_convolution c, std::size_t groups) {
    c.groups = groups;
    return c;
}

inline std::vector<float> drawn(std::size_t count, float largest, std::uint64_t seed) {
    std::vector<float> values(count);
    for (float& value : values)
        value = largest * draw(seed);
    return values;
}

/// A convolution on numbers drawn at random, and the outputs of some frames on some threads.
template <frame_convolution C>
struct trial {
    using step = tactnet::convolution_step<tactnet::single_precision, C>;
    static constexpr std::size_t in_size = tactnet::pad_to_cache_line(C.window.input.area() * C.input_stride),
                                 out_size =
                                     tactnet::pad_to_cache_line(step::output.area() * step::output_stride);
    tactnet::aligned_vector<float> packed = tactnet::aligned_vector<float>(step::packed_elements), in, out;

    explicit trial(std::size_t frames = 1) {
        const std::vector<float> folded = drawn(step::folded_elements, 0.7F, 3),
                                 drawn_inputs = drawn(frames * in_size, 2, 5);
        step::pack(folded.data(), packed.data());
        in.assign(drawn_inputs.begin(), drawn_inputs.end());
        // Lanes without a channel hold zeros.
        for (std::size_t i = 0; i < in.size(); ++i)
            if (i % in_size % C.input_stride >= C.window.input.channels)
                in[i] = 0;
        out = tactnet::aligned_vector<float>(frames * out_size);
        if (C.accumulates)
            std::copy_n(in.begin(), std::min(in.size(), out.size()), out.begin());
    }
    trial& run() {
        tactnet::aligned_vector<float> workspace(step::workspace_elements + 1);
        step::run(packed.data(), in.data(), out.data(), workspace.data());
        return *this;
    }
    /// The function in a step of its own.
    template <class Function>
    trial& then() {
        tactnet::activation_step<tactnet::single_precision, Function, step::output, step::output_stride>::run(
            nullptr, out.data(), out.data(), nullptr);
        return *this;
    }
};

} // namespace support
