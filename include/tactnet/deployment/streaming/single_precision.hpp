#pragma once

#include <tactnet/deployment/streaming/chain.hpp>
#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/kernels/frame/ordered_product.hpp>
#include <tactnet/lowering/frame_ring.hpp>
#include <tactnet/lowering/stream_step.hpp>
#include <tactnet/operators/activations/function.hpp>
#include <tactnet/operators/recurrent/cell.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

// The steps of streams in single precision.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The base of steps in single precision.
template <std::size_t Features, std::size_t Outputs, std::size_t Parameters = 0>
struct float_stream_step {
    struct state {};
    using format = single_precision;
    using element = float;
    using output_number = float;
    static constexpr std::size_t features = Features, outputs = Outputs;
    static constexpr std::size_t map_elements = kernels::padded_size<float>(Outputs);
    static constexpr std::size_t parameters = Parameters, folded_elements = Parameters, packed_elements = 0,
                                 workspace_elements = 0;
    static void fold(const float* values, float* folded) { std::copy_n(values, Parameters, folded); }
    static constexpr void pack(const float*, float*) {}
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

} // namespace detail

template <class Cell, std::size_t Features, std::size_t Hidden>
struct recurrent_stream_step<single_precision, Cell, Features, Hidden>
    : detail::float_stream_step<Features, Hidden, Cell::gates * Hidden*(Features + Hidden + 2)> {
private:
    static constexpr std::size_t units = kernels::padded_size<float>(Hidden); // of a gate, in whole vectors
    static constexpr std::size_t rows = Cell::gates * Hidden;
    // Where the arrays begin among the parameters.
    static constexpr std::size_t hidden_weights = rows * Features,
                                 input_biases = hidden_weights + rows * Hidden,
                                 hidden_biases = input_biases + rows;
    using input_product = kernels::ordered_product<Cell::gates * units, Features>;
    using hidden_product = kernels::ordered_product<Cell::gates * units, Hidden>;

public:
    static constexpr std::size_t packed_elements =
        input_product::packed_elements + hidden_product::packed_elements;

    /// Zero before the first frame.
    struct state {
        alignas(vector_alignment) std::array<float, Cell::states * units> elements{};
    };

    static constexpr void pack(const float* values, float* packed) {
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
        input_product::pack(matrix(values, Features), biases(values + input_biases), packed);
        hidden_product::pack(matrix(values + hidden_weights, Hidden), biases(values + hidden_biases),
                             packed + input_product::packed_elements);
    }
    static void run(const float* packed, const float* in, state& s, float* out, float*) noexcept {
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
        return most_content + detail::product_bound(values, Features, values + input_biases, rows, input) +
               detail::product_bound(values + hidden_weights, Hidden, values + hidden_biases, rows,
                                     most_content);
    }
};

template <std::size_t Features, std::size_t Filters, std::size_t Taps, std::size_t Dilation, bool Rectified>
struct causal_stream_step<single_precision, Features, Filters, Taps, Dilation, Rectified>
    : detail::float_stream_step<Features, Filters, Filters*(Features* Taps + 1)> {
private:
    static constexpr std::size_t inputs = Features * Taps; // of one output
    using product = kernels::ordered_product<Filters, inputs>;

public:
    static constexpr std::size_t packed_elements = product::packed_elements;

    using state = detail::frame_ring<float, Features, Taps, Dilation>;

    static constexpr void pack(const float* values, float* packed) {
        product::pack([&](std::size_t row, std::size_t input) { return values[row * inputs + input]; },
                      [&](std::size_t row) { return values[Filters * inputs + row]; }, packed);
    }
    static void run(const float* packed, const float* in, [[maybe_unused]] state& s, float* out,
                    float*) noexcept {
        if constexpr (Taps == 1)
            product::run(packed, in, out);
        else
            product::run(packed, look_back(in, s).data(), out);
        if constexpr (Rectified)
            kernels::relu_forward(out, out, causal_stream_step::map_elements);
    }
    [[nodiscard]] static double output_bound(const float* values, double input) {
        return detail::product_bound(values, inputs, values + Filters * inputs, Filters, input);
    }

private:
    /// The inputs of an output, [feature][tap]; the present frame takes the place of the oldest.
    static std::array<float, inputs> look_back(const float* in, state& s) noexcept {
        std::array<float, inputs> taken;
        for (std::size_t tap = 0; tap < Taps; ++tap) {
            const float* const from = tap + 1 == Taps ? in : s.before(tap);
            for (std::size_t f = 0; f < Features; ++f)
                taken[f * Taps + tap] = from[f];
        }
        std::copy_n(in, Features, s.replace_oldest());
        return taken;
    }
};

template <class Function, std::size_t Features>
struct activation_stream_step<single_precision, Function, Features>
    : detail::float_stream_step<Features, Features> {
    using typename detail::float_stream_step<Features, Features>::state;

    /// The functions of a batch.
    static void run(const float*, const float* in, state&, float* out, float*) noexcept {
        constexpr std::size_t count = activation_stream_step::map_elements;
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

template <std::size_t Features>
struct copying_stream_step<single_precision, Features> : detail::float_stream_step<Features, Features> {
    using typename detail::float_stream_step<Features, Features>::state;

    static void run(const float*, const float* in, state&, float* out, float*) noexcept {
        std::copy_n(in, copying_stream_step::map_elements, out);
    }
    [[nodiscard]] static double output_bound(const float*, double input) { return input; }
};

template <class Main, class Skip>
struct residual_stream_step<single_precision, Main, Skip>
    : detail::float_stream_step<Main::features, Main::outputs, Main::parameters + Skip::parameters> {
    static constexpr std::size_t packed_elements = Main::packed_elements + Skip::packed_elements;

    struct state {
        [[no_unique_address]] typename Main::state of_main;
        [[no_unique_address]] typename Skip::state of_skip;
    };

    static constexpr void pack(const float* values, float* packed) {
        Main::pack(values, packed);
        Skip::pack(values + Main::parameters, packed + Main::packed_elements);
    }
    static void run(const float* packed, const float* in, state& s, float* out, float* memory) noexcept {
        alignas(vector_alignment) std::array<float, Main::map_elements> added;
        Main::run(packed, in, s.of_main, out, memory);
        Skip::run(packed + Main::packed_elements, in, s.of_skip, added.data(), memory);
        kernels::add(out, added.data(), out, Main::map_elements);
    }
    [[nodiscard]] static double output_bound(const float* values, double input) {
        return Main::output_bound(values, input) + Skip::output_bound(values + Main::parameters, input);
    }
};

}} // namespace tactnet
