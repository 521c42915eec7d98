#pragma once

#include <tactnet/deployment/eight_bit/layout.hpp>
#include <tactnet/deployment/eight_bit/steps/convolution.hpp>
#include <tactnet/deployment/eight_bit/steps/elementwise.hpp>
#include <tactnet/deployment/eight_bit/streaming/observation.hpp>
#include <tactnet/deployment/streaming/stream_step.hpp>
#include <tactnet/kernels/integer/recurrent.hpp>
#include <tactnet/layers/time/gru.hpp>
#include <tactnet/layers/time/lstm.hpp>

#include <algorithm>
#include <array>
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

/// A layer whose outputs pass a ReLU, in one step.
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

/// The cell of a layer in integers.
template <class Cell>
struct word_cell;
template <>
struct word_cell<gru_cell> : kernels::word_gru_cell {};
template <>
struct word_cell<lstm_cell> : kernels::word_lstm_cell {};

} // namespace detail

/// Recurrent layers: two products and the cells. States have 16 bits; their bytes have a range of their own.
template <class Cell, std::size_t Hidden, shape Input, class In, class Out>
    requires requires {
        sizeof(detail::word_cell<Cell>);
    }
struct stream_step<recurrent<Cell, Hidden>, Input, eight_bit_between<In, Out>> {
private:
    using spec = recurrent<Cell, Hidden>;
    using layer = typename spec::template layer<float, Input>;
    using cells = kernels::word_cells<detail::word_cell<Cell>, Hidden>;
    using input_product = detail::frames_product<In, float, 1, Input.channels, spec::rows>;
    using hidden_product = detail::frames_product<std::uint8_t, float, 1, Hidden, spec::rows>;
    static constexpr std::size_t room = // floats
        pad_to_cache_line(std::max(cells::sums, input_product::output_stride));

public:
    using output_number = Out;
    static constexpr std::size_t folded_elements =
                                     input_product::folded_elements + hidden_product::folded_elements,
                                 packed_elements =
                                     input_product::packed_elements + hidden_product::packed_elements,
                                 workspace_elements = std::max(input_product::workspace_elements,
                                                               hidden_product::workspace_elements);
    /// The bytes of hidden states.
    static constexpr map_range hidden_range{1.0F / kernels::cell_numbers::hidden_steps,
                                            kernels::cell_numbers::hidden_zero};

    /// Zero before the first frame.
    struct state {
        std::array<std::int16_t, detail::word_cell<Cell>::states * cells::units> elements{};
    };

    static void fold(const float* values, float* folded) {
        float* const hidden = folded + input_product::folded_elements;
        std::copy_n(values, input_product::weights, folded);
        std::copy_n(values + layer::input_biases, spec::rows, folded + input_product::weights);
        std::copy_n(values + layer::hidden_weights, hidden_product::weights, hidden);
        std::copy_n(values + layer::hidden_biases, spec::rows, hidden + hidden_product::weights);
    }
    static map_range set_ranges(float* folded, const map_range& input, const map_range*&) {
        input_product::set_ranges(folded, {input, {}, {}});
        hidden_product::set_ranges(folded + input_product::folded_elements, {hidden_range, {}, {}});
        return hidden_range;
    }
    static void append_arrays(folded_layout& to, const std::string& name) {
        detail::append_step(to, name + ".frame", input_product::arrays, input_product::largest_input);
        detail::append_step(to, name + ".state", hidden_product::arrays, hidden_product::largest_input);
    }
    static void pack(const float* folded, std::int8_t* packed) {
        input_product::pack(folded, packed);
        hidden_product::pack(folded + input_product::folded_elements,
                             packed + input_product::packed_elements);
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, state& s, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        constexpr std::size_t bytes = pad_to_cache_line<std::uint8_t>(cells::units);
        alignas(vector_alignment) std::array<float, room> from_input, from_state;
        alignas(vector_alignment) std::array<std::uint8_t, bytes> hidden{};
        cells::write_bytes(s.elements.data(), hidden.data());
        const auto multiply = [&](auto product, const std::int8_t* weights, const std::uint8_t* x,
                                  std::array<float, room>& to) {
            using step = typename decltype(product)::type;
            step::run(weights, x, reinterpret_cast<std::uint8_t*>(to.data()), memory);
            std::fill(to.begin() + step::output_stride, to.end(), 0.0F); // read with the last vector
        };
        multiply(std::type_identity<input_product>{}, packed, in, from_input);
        multiply(std::type_identity<hidden_product>{}, packed + input_product::packed_elements, hidden.data(),
                 from_state);
        cells::update(from_input.data(), from_state.data(), s.elements.data(), hidden.data());
        if constexpr (std::is_same_v<Out, float>) {
            auto* const to = reinterpret_cast<float*>(out);
            for (std::size_t h = 0; h < Hidden; ++h)
                to[h] = static_cast<float>(s.elements[h]) / 32768;
        } else {
            std::copy_n(hidden.data(), Hidden, out);
        }
    }
    static std::vector<float> observe(const float* values, const std::vector<float>& in,
                                      detail::stream_observation& found) {
        return found.run<stream_step<spec, Input>, Input.channels, Hidden>(values, in);
    }
};

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

/// A layer and the ReLU after it in single precision, for calibration.
template <class Spec, shape Input>
struct stream_step<detail::rectified<Spec>, Input> : stream_step<Spec, Input> {
    static void run(const float* packed, const float* in, typename stream_step<Spec, Input>::state& s,
                    float* out) noexcept {
        stream_step<Spec, Input>::run(packed, in, s, out);
        kernels::relu_forward(out, out, kernels::padded_size<float>(Spec::costs(Input).output.channels));
    }
};

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
