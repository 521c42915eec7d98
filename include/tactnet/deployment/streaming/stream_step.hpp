#pragma once

#include <tactnet/deployment/steps/step.hpp>
#include <tactnet/kernels/frame/ordered_product.hpp>
#include <tactnet/layers/activations/activation.hpp>
#include <tactnet/layers/dense.hpp>
#include <tactnet/layers/dropout.hpp>
#include <tactnet/layers/time/causal_conv1d.hpp>
#include <tactnet/layers/time/last_frame.hpp>
#include <tactnet/layers/time/recurrent.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

// What a layer does with one frame of a stream, specialised for each layer that can. A step has
//   state                          what it remembers from frame to frame; empty for most
//   packed_elements, pack(values, packed)
//   run(packed, in, state, out)    from the features of a frame to those of the next layer, in aligned arrays
//                                  of whole vectors; the bits are those of the layer in a batch
//   output_bound(values, input)    the largest magnitude of outputs and sums, for inputs of such a magnitude

namespace tactnet { inline namespace TACTNET_ARCH {

/// What a layer does with one frame, specialised for each layer that can run frame by frame, and for each
/// number format. deployment/eight_bit/streaming has the steps in 8 bits.
template <class Spec, shape Input, class Format = single_precision>
struct stream_step;

/// Whether `deploy_stream` can run the layer frame by frame.
template <class Spec, shape Input, class Format = single_precision>
concept runs_in_streams = requires {
    sizeof(stream_step<Spec, Input, Format>);
};

namespace detail {

/// A step without parameters and without memory.
struct stateless_step {
    struct state {};
    static constexpr std::size_t packed_elements = 0;
    static void pack(const float*, float*) {}
};

/// The largest magnitude of weights[row] · x + biases[row], over all rows.
[[nodiscard]] inline double product_bound(const float* weights, std::size_t inputs, const float* biases,
                                          std::size_t rows, double input) {
    double most = 0;
    for (std::size_t row = 0; row < rows; ++row) {
        double sum = 0;
        for (std::size_t i = 0; i < inputs; ++i)
            sum += std::abs(static_cast<double>(weights[row * inputs + i]));
        most = std::max(most, sum * input + std::abs(static_cast<double>(biases[row])));
    }
    return most;
}

/// Packs a matrix [rows, inputs] and its biases.
template <class Product>
void pack_product(const float* weights, std::size_t inputs, const float* biases, float* packed) {
    Product::pack([&](std::size_t row, std::size_t input) { return weights[row * inputs + input]; },
                  [&](std::size_t row) { return biases[row]; }, packed);
}

} // namespace detail

/// Recurrent layers remember their state.
template <class Cell, std::size_t Hidden, shape Input>
struct stream_step<recurrent<Cell, Hidden>, Input> {
    using layer = typename recurrent<Cell, Hidden>::template layer<float, Input>;
    static constexpr std::size_t features = Input.channels,
                                 units = kernels::padded_size<float>(Hidden); ///< of a gate, in whole vectors
    using input_product = kernels::ordered_product<Cell::gates * units, features>;
    using hidden_product = kernels::ordered_product<Cell::gates * units, Hidden>;
    static constexpr std::size_t packed_elements =
        input_product::packed_elements + hidden_product::packed_elements;

    /// Zero before the first frame.
    struct state {
        alignas(vector_alignment) std::array<float, Cell::states * units> elements{};
    };

    static void pack(const float* values, float* packed) {
        // Each gate begins with a whole vector.
        const auto place = [](std::size_t row) { return row / units * Hidden + row % units; };
        const auto exists = [](std::size_t row) { return row % units < Hidden; };
        const auto matrix = [&](const float* weights, std::size_t inputs) {
            return [=](std::size_t row, std::size_t input) {
                return exists(row) ? weights[place(row) * inputs + input] : 0.0F;
            };
        };
        const auto biases = [&](const float* from) {
            return [=](std::size_t row) { return exists(row) ? from[place(row)] : 0.0F; };
        };
        input_product::pack(matrix(values, features), biases(values + layer::input_biases), packed);
        hidden_product::pack(matrix(values + layer::hidden_weights, Hidden),
                             biases(values + layer::hidden_biases), packed + input_product::packed_elements);
    }
    static void run(const float* packed, const float* in, state& s, float* out) noexcept {
        alignas(vector_alignment) std::array<float, Cell::gates * units> from_input, from_state;
        input_product::run(packed, in, from_input.data());
        hidden_product::run(packed + input_product::packed_elements, s.elements.data(), from_state.data());
        alignas(vector_alignment) std::array<float, Cell::kept_count * units> kept;
        detail::update_cells<Cell>(units, from_input.data(), from_state.data(), s.elements.data(),
                                   kept.data());
        std::copy_n(s.elements.data(), units, out);
    }
    /// The content of an LSTM stays below 2²⁴: a frame adds at most 1, which is rounded away there. Hidden
    /// states leave −1 … 1 by roundings alone.
    [[nodiscard]] static double output_bound(const float* values, double input) {
        constexpr double most_content = 0x1p24;
        return most_content +
               detail::product_bound(values, features, values + layer::input_biases,
                                     recurrent<Cell, Hidden>::rows, input) +
               detail::product_bound(values + layer::hidden_weights, Hidden, values + layer::hidden_biases,
                                     recurrent<Cell, Hidden>::rows, most_content);
    }
};

/// Causal convolutions remember the frames that they look back to.
template <std::size_t Filters, std::size_t Taps, std::size_t Dilation, shape Input>
struct stream_step<causal_conv1d<Filters, Taps, Dilation>, Input> {
    using layer = typename causal_conv1d<Filters, Taps, Dilation>::template layer<float, Input>;
    static constexpr std::size_t features = Input.channels,
                                 frames = causal_conv1d<Filters, Taps, Dilation>::frames_before;
    using product = kernels::ordered_product<Filters, features * Taps>;
    static constexpr std::size_t packed_elements = product::packed_elements;

    /// The frames before the present one, which are zero at first, in a ring; `next` is the oldest.
    struct state {
        std::array<float, frames * features> elements{};
        std::uint32_t next = 0;
    };

    static void pack(const float* values, float* packed) {
        detail::pack_product<product>(values, layer::inputs, values + layer::biases, packed);
    }
    static void run(const float* packed, const float* in, state& s, float* out) noexcept {
        std::array<float, features * Taps> inputs;
        for (std::size_t tap = 0; tap < Taps; ++tap) {
            // The frame (Taps − 1 − tap) · Dilation before the present one is this far after the oldest.
            std::size_t frame = s.next + tap * Dilation;
            if (frame >= frames)
                frame -= frames;
            const float* const from = tap + 1 == Taps ? in : s.elements.data() + frame * features;
            for (std::size_t f = 0; f < features; ++f)
                inputs[f * Taps + tap] = from[f];
        }
        if constexpr (frames > 0) {
            std::copy_n(in, features, s.elements.data() + s.next * features);
            s.next = s.next + 1 == frames ? 0 : s.next + 1;
        }
        product::run(packed, inputs.data(), out);
    }
    [[nodiscard]] static double output_bound(const float* values, double input) {
        return detail::product_bound(values, layer::inputs, values + layer::biases, Filters, input);
    }
};

/// A dense layer after `last_frame`.
template <std::size_t Outputs, shape Input>
    requires(Input.area() == 1)
struct stream_step<dense<Outputs>, Input> : detail::stateless_step {
    static constexpr std::size_t inputs = Input.size();
    using product = kernels::ordered_product<Outputs, inputs>;
    static constexpr std::size_t packed_elements = product::packed_elements;

    static void pack(const float* values, float* packed) {
        detail::pack_product<product>(values, inputs, values + Outputs * inputs, packed);
    }
    static void run(const float* packed, const float* in, state&, float* out) noexcept {
        product::run(packed, in, out);
    }
    [[nodiscard]] static double output_bound(const float* values, double input) {
        return detail::product_bound(values, inputs, values + Outputs * inputs, Outputs, input);
    }
};

/// Activations, with the functions of a batch.
template <class Function, shape Input>
struct stream_step<activation<Function>, Input> : detail::stateless_step {
    static void run(const float*, const float* in, state&, float* out) noexcept {
        constexpr std::size_t count = kernels::padded_size<float>(Input.channels);
        if constexpr (detail::is_relu<Function>())
            kernels::relu_forward(in, out, count);
        else
            detail::transform<Function>([](auto x) { return Function::value(x); }, count, out, in);
    }
    /// Between these two numbers, functions that are used as activations grow no faster than their input.
    [[nodiscard]] static double output_bound(const float*, double input) {
        return std::max({input, std::abs(Function::value(input)), std::abs(Function::value(-input)), 1.0});
    }
};

namespace detail {

/// A layer that changes nothing in a stream.
template <shape Input>
struct copying_step : stateless_step {
    static void run(const float*, const float* in, state&, float* out) noexcept {
        std::copy_n(in, kernels::padded_size<float>(Input.channels), out);
    }
    [[nodiscard]] static double output_bound(const float*, double input) { return input; }
};

} // namespace detail

/// In a stream, the last frame is the present one.
template <shape Input>
struct stream_step<last_frame, Input> : detail::copying_step<Input> {};
/// Dropout changes nothing after training.
template <unsigned Percent, shape Input>
struct stream_step<dropout<Percent>, Input> : detail::copying_step<Input> {};

}} // namespace tactnet
