#pragma once

#include <tactnet/deployment/eight_bit/layout.hpp>
#include <tactnet/deployment/eight_bit/steps/convolution.hpp>
#include <tactnet/deployment/eight_bit/steps/elementwise.hpp>
#include <tactnet/deployment/eight_bit/streaming/observation.hpp>
#include <tactnet/deployment/streaming/stream_step.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <type_traits>
#include <vector>

// What a layer does with one frame of a stream in 8 bits, in the format eight_bit_between<Input, Output>: it
// reads bytes, or words of 16 bits if it is the first; it writes bytes, or floats if it is the last and can.
// Products are the convolutions of one frame that networks of images have. A step has
//   state, output_number           what it remembers; bytes, words or floats
//   folded_elements, packed_elements, workspace_elements
//   fold(values, folded)           from the parameters of the layer
//   set_ranges(folded, input, next)  the ranges of its maps, of which observed ones are read from `next`;
//                                  returns the range of its output
//   append_arrays(layout, name)    the names of its folded numbers, for checks
//   pack(folded, packed)
//   run(packed, in, state, out, memory)   arrays are padded to cache lines
//   observe(values, in, found)     for calibration: its outputs in single precision

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// A layer with the ReLU after it, in one step.
template <class Spec>
struct rectified {
    static constexpr layer_costs costs(const shape& input) { return Spec::costs(input); }
};

/// A step that networks of images have, too: with parameters that are folded as they are, and without memory.
template <class Step, class Exact, std::size_t Features, class Output, bool OwnRange>
struct frame_stream_step {
    struct state {};
    using output_number = Output;
    static constexpr std::size_t folded_elements = Step::folded_elements,
                                 packed_elements = Step::packed_elements,
                                 workspace_elements = Step::workspace_elements;

    static void fold(const float* values, float* folded) {
        if constexpr (requires { Step::weights; })
            std::copy_n(values, Step::weights + Step::output.channels, folded);
    }
    static map_range set_ranges(float* folded, const map_range& input, const map_range*& next) {
        const step_ranges ranges{input, {}, OwnRange ? *next++ : input};
        if constexpr (requires { &Step::set_ranges; })
            Step::set_ranges(folded, ranges);
        else
            Step::arrays.write_ranges(folded, ranges);
        return ranges.output;
    }
    static void append_arrays(folded_layout& to, const std::string& name) {
        if constexpr (requires { Step::largest_input; })
            append_step(to, name, Step::arrays, Step::largest_input);
        else
            append_step(to, name, Step::arrays, 0);
    }
    static void pack(const float* folded, std::int8_t* packed) { Step::pack(folded, packed); }
    static void run(const std::int8_t* packed, const std::uint8_t* in, state&, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        Step::run(packed, in, out, memory);
    }
    static std::vector<float> observe(const float* values, const std::vector<float>& in,
                                      stream_observation& found) {
        std::vector<float> out = found.run<Exact, Features, Step::output.channels>(values, in);
        if constexpr (OwnRange)
            found.observe(out);
        return out;
    }
};

/// Elements from one frame to the next, of so many features: products take four bytes at once.
[[nodiscard]] constexpr std::size_t frame_stride(std::size_t features) {
    return round_up(features, 4);
}
/// A product in 8 bits with `Frames` frames.
template <class Input, class Output, std::size_t Frames, std::size_t Features, std::size_t Outputs,
          bool Rectified = false>
using frames_product =
    convolution_step<eight_bit_between<Input, Output>,
                     kernels::frame_convolution{.window = {{Frames, 1, Features}, {Frames, 1}, 1},
                                                .filters = Outputs,
                                                .input_stride = frame_stride(Features),
                                                .activation = Rectified ? fused<relu_function>
                                                                        : &kernels::no_activation}>;

} // namespace detail

/// A layer and the ReLU after it in single precision, for calibration.
template <class Spec, shape Input>
struct stream_step<detail::rectified<Spec>, Input> : stream_step<Spec, Input> {
    static void run(const float* packed, const float* in, typename stream_step<Spec, Input>::state& s,
                    float* out) noexcept {
        stream_step<Spec, Input>::run(packed, in, s, out);
        kernels::relu_forward(out, out, kernels::padded_size<float>(Spec::costs(Input).output.channels));
    }
};

/// A dense layer after `last_frame`.
template <std::size_t Outputs, shape Input, class In, class Out>
    requires(Input.area() == 1)
struct stream_step<dense<Outputs>, Input, eight_bit_between<In, Out>>
    : detail::frame_stream_step<detail::frames_product<In, Out, 1, Input.channels, Outputs>,
                                stream_step<dense<Outputs>, Input>, Input.channels, Out,
                                std::is_same_v<Out, std::uint8_t>> {};
template <std::size_t Outputs, shape Input, class In, class Out>
    requires(Input.area() == 1)
struct stream_step<detail::rectified<dense<Outputs>>, Input, eight_bit_between<In, Out>>
    : detail::frame_stream_step<detail::frames_product<In, Out, 1, Input.channels, Outputs, true>,
                                stream_step<detail::rectified<dense<Outputs>>, Input>, Input.channels, Out,
                                std::is_same_v<Out, std::uint8_t>> {};

namespace detail {

template <class Function, std::size_t Channels>
using byte_activation = activation_step<eight_bit, Function, shape{1, 1, Channels}, Channels>;

} // namespace detail

/// Activations: a clamp of bytes for a ReLU, otherwise a table.
template <class Function, shape Input, class Out>
struct stream_step<activation<Function>, Input, eight_bit_between<std::uint8_t, Out>>
    : detail::frame_stream_step<detail::byte_activation<Function, Input.channels>,
                                stream_step<activation<Function>, Input>, Input.channels, std::uint8_t,
                                !detail::byte_activation<Function, Input.channels>::clamps> {};

}} // namespace tactnet
