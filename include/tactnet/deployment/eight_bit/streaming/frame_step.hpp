#pragma once

#include <tactnet/deployment/streaming/single_precision.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/operators/activations/eight_bit.hpp>
#include <tactnet/operators/convolution/eight_bit.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>

// What a layer does with one frame of a stream in 8 bits, in the format eight_bit_between<Input, Output>: it
// reads bytes, or words of 16 bits if it is the first; it writes bytes, or floats if it is the last and can.
// Products are the convolutions of one frame that networks of images have. In addition to the members of
// every step (lowering/stream_step.hpp), a step has
//   exact                          the step in single precision
//   observes_output                whether calibration observes the range of its output
//   set_ranges(folded, input, next)  the ranges of its maps, of which observed ones are read from `next`;
//                                  returns the range of its output
//   visit_arrays(to)               calls to(part, arrays, largest input) for its folded_arrays, in order

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// The base of steps in 8 bits, of numbers that another step gives.
template <class Format, class Output, class Sizes>
struct byte_stream_step {
    struct state {};
    using format = Format;
    using element = std::uint8_t;
    using output_number = Output;
    static constexpr std::size_t features = Sizes::features, outputs = Sizes::outputs,
                                 parameters = Sizes::parameters;
    static constexpr std::size_t map_elements =
        pad_to_cache_line<std::uint8_t>(pad_to_cache_line(outputs) * sizeof(Output));
};

/// A step that networks of images have, too: with parameters that are folded as they are, and without memory.
template <class Format, class Exact, class Output, class Step, bool OwnRange>
struct frame_stream_step : byte_stream_step<Format, Output, Exact> {
    using typename byte_stream_step<Format, Output, Exact>::state;
    using exact = Exact;
    static constexpr bool observes_output = OwnRange;
    static constexpr std::size_t folded_elements = Step::folded_elements,
                                 packed_elements = Step::packed_elements,
                                 workspace_elements = Step::workspace_elements;

    static void fold(const float* values, float* folded) {
        std::copy_n(values, frame_stream_step::parameters, folded);
    }
    static map_range set_ranges(float* folded, const map_range& input, const map_range*& next) {
        const step_ranges ranges{input, {}, OwnRange ? *next++ : input};
        write_ranges<Step>(folded, ranges);
        return ranges.output;
    }
    static void visit_arrays(auto&& to) { to("", Step::arrays, Step::largest_input); }
    static constexpr void pack(const float* folded, std::int8_t* packed) { Step::pack(folded, packed); }
    static void run(const std::int8_t* packed, const std::uint8_t* in, state&, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        Step::run(packed, in, out, memory);
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

template <class Function, std::size_t Channels>
using byte_activation = activation_step<eight_bit, Function, shape{1, 1, Channels}, Channels>;

} // namespace detail

}} // namespace tactnet
