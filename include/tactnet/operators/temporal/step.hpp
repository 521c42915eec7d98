#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/kernels/frame/dense.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/operators/temporal/cells.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A recurrent layer of a cell (operators/temporal/cells.hpp) on one frame of a stream.
template <class Format, class Cell, std::size_t Features, std::size_t Hidden>
struct recurrent_step;
template <class Format, class Cell, std::size_t Features, std::size_t Hidden>
struct step_description<recurrent_step<Format, Cell, Features, Hidden>> {
    static constexpr const char* header = "tactnet/operators/temporal/step.hpp";
    static constexpr void visit(auto&& to) {
        to("tactnet::recurrent_step", Cell::title, std::type_identity<Format>{}, std::type_identity<Cell>{},
           Features, Hidden);
    }
};

/// Folded numbers are the parameters of the layer, in their order.
template <class Cell, std::size_t Features, std::size_t Hidden>
struct recurrent_step<single_precision, Cell, Features, Hidden>
    : step_base<single_precision, shape{1, 1, Hidden}, kernels::padded_size<float>(Hidden)> {
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
    static constexpr std::size_t folded_elements = hidden_biases + rows,
                                 packed_elements =
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
    static void run(const float* packed, const float* in, float* out, float*, state& s) noexcept {
        alignas(vector_alignment) std::array<float, Cell::gates * units> from_input, from_state;
        input_product::run(packed, in, from_input.data());
        hidden_product::run(packed + input_product::packed_elements, s.elements.data(), from_state.data());
        alignas(vector_alignment) std::array<float, Cell::kept_count * units> kept;
        detail::update_cells<Cell>(units, from_input.data(), from_state.data(), s.elements.data(),
                                   kept.data());
        std::memcpy(out, s.elements.data(), units * sizeof(float)); // they never overlap
    }
    /// The content of an LSTM stays below 2²⁴: a frame adds at most 1, which is rounded away there. Hidden
    /// states leave −1 … 1 by roundings alone.
    [[nodiscard]] static double output_bound(const float* values, double input) {
        constexpr double most_content = 0x1p24;
        return most_content + detail::largest_sum(values, values + input_biases, rows, Features, input) +
               detail::largest_sum(values + hidden_weights, values + hidden_biases, rows, Hidden,
                                   most_content);
    }
};

namespace detail {

/// The frames before the present one that a causal convolution looks back to, zero at first, in a ring.
template <class Number, std::size_t Features, std::size_t Taps, std::size_t Dilation>
struct frame_ring {
    static constexpr std::size_t frames = (Taps - 1) * Dilation;
    std::array<Number, frames * Features> elements{};
    std::uint32_t next = 0; ///< the oldest, below `frames`

    /// `next`, of whatever bytes: a caller may have filled the state with damaged ones.
    [[nodiscard]] std::size_t oldest() const noexcept { return next < frames ? next : 0; }

    /// The features of the frame (Taps − 1 − tap) · Dilation before the present one, for all taps but the
    /// last.
    [[nodiscard]] const Number* before(std::size_t tap) const noexcept {
        std::size_t frame = oldest() + tap * Dilation; // this far after the oldest
        if (frame >= frames)
            frame -= frames;
        return elements.data() + frame * Features;
    }
    /// Where the features of the present frame take the place of the oldest. Call it once for each frame.
    [[nodiscard]] Number* replace_oldest() noexcept {
        const std::size_t place = oldest();
        next = static_cast<std::uint32_t>(place + 1 == frames ? 0 : place + 1);
        return elements.data() + place * Features;
    }
};

/// The base of steps that look back, if there are several taps.
template <class Number, std::size_t Features, std::size_t Taps, std::size_t Dilation>
struct looks_back {
    using state = frame_ring<Number, Features, Taps, Dilation>;
};
template <class Number, std::size_t Features, std::size_t Dilation>
struct looks_back<Number, Features, 1, Dilation> {};

} // namespace detail

/// A causal convolution on one frame of a stream, with the ReLU after it or without. With one tap it is a
/// dense layer and remembers nothing.
template <class Format, std::size_t Features, std::size_t Filters, std::size_t Taps, std::size_t Dilation,
          bool Rectified>
struct causal_step;
template <class Format, std::size_t Features, std::size_t Filters, std::size_t Taps, std::size_t Dilation,
          bool Rectified>
struct step_description<causal_step<Format, Features, Filters, Taps, Dilation, Rectified>> {
    static constexpr const char* header = "tactnet/operators/temporal/step.hpp";
    static constexpr void visit(auto&& to) {
        constexpr const char* titles[] = {"Dense", "Dense, ReLU", "Causal convolution",
                                          "Causal convolution, ReLU"};
        to("tactnet::causal_step", titles[(Taps > 1 ? 2 : 0) + (Rectified ? 1 : 0)],
           std::type_identity<Format>{}, Features, Filters, Taps, Dilation, Rectified);
    }
};

template <std::size_t Features, std::size_t Filters, std::size_t Taps, std::size_t Dilation, bool Rectified>
struct causal_step<single_precision, Features, Filters, Taps, Dilation, Rectified>
    : step_base<single_precision, shape{1, 1, Filters}, kernels::padded_size<float>(Filters)>,
      detail::looks_back<float, Features, Taps, Dilation> {
private:
    static constexpr std::size_t inputs = Features * Taps; // of one output
    using product = kernels::ordered_product<Filters, inputs>;

public:
    static constexpr std::size_t folded_elements = Filters * (inputs + 1),
                                 packed_elements = product::packed_elements;

    static constexpr void pack(const float* values, float* packed) {
        product::pack([&](std::size_t row, std::size_t input) { return values[row * inputs + input]; },
                      [&](std::size_t row) { return values[Filters * inputs + row]; }, packed);
    }
    static void run(const float* packed, const float* in, float* out, float*, auto&... states) noexcept {
        if constexpr (Taps == 1)
            product::run(packed, in, out);
        else
            product::run(packed, look_back(in, states...).data(), out);
        if constexpr (Rectified)
            kernels::relu_forward(out, out, causal_step::output_stride);
    }
    [[nodiscard]] static double output_bound(const float* values, double input) {
        return detail::largest_sum(values, Filters, inputs, input);
    }

private:
    /// The inputs of an output, [feature][tap]; the present frame takes the place of the oldest.
    static std::array<float, inputs> look_back(const float* in, auto& state) noexcept {
        std::array<float, inputs> found;
        for (std::size_t tap = 0; tap < Taps; ++tap) {
            const float* const from = tap + 1 == Taps ? in : state.before(tap);
            for (std::size_t f = 0; f < Features; ++f)
                found[f * Taps + tap] = from[f];
        }
        std::copy_n(in, Features, state.replace_oldest());
        return found;
    }
};

}} // namespace tactnet
