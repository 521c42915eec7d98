#pragma once

#include <tactnet/kernels/integer/recurrent.hpp>
#include <tactnet/operators/activations/function.hpp>
#include <tactnet/operators/convolution/eight_bit.hpp>
#include <tactnet/operators/temporal/cells.hpp>
#include <tactnet/operators/temporal/step.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Elements from one frame to the next, of so many features: products take four bytes at once.
[[nodiscard]] constexpr std::size_t frame_stride(std::size_t features) {
    return round_up(features, 4);
}
/// A product in 8 bits with `Frames` frames: a convolution with one output.
template <class Format, std::size_t Frames, std::size_t Features, std::size_t Outputs, bool Rectified = false>
using frames_product =
    convolution_step<Format, kernels::frame_convolution{.window = {{Frames, 1, Features}, {Frames, 1}, 1},
                                                        .filters = Outputs,
                                                        .input_stride = frame_stride(Features),
                                                        .activation = Rectified ? fused<relu_function>
                                                                                : &kernels::no_activation}>;

} // namespace detail

template <class In, class Out, std::size_t Features, std::size_t Filters, std::size_t Taps,
          std::size_t Dilation, bool Rectified>
struct causal_step<eight_bit_between<In, Out>, Features, Filters, Taps, Dilation, Rectified>
    : detail::frames_product<eight_bit_between<In, Out>, Taps, Features, Filters, Rectified>,
      detail::looks_back<In, Features, Taps, Dilation> {
private:
    using product = detail::frames_product<eight_bit_between<In, Out>, Taps, Features, Filters, Rectified>;
    static constexpr std::size_t stride = detail::frame_stride(Features);
    static_assert(Dilation > 0);

public:
    // The product's, then the zero of its input. The numbers of the state are those of frames less that zero.
    static constexpr std::size_t packed_elements =
        product::packed_elements + (Taps > 1 ? pad_to_cache_line<std::int8_t>(1) : 0);

    static constexpr void pack(const float* folded, std::int8_t* packed) {
        product::pack(folded, packed);
        if constexpr (Taps > 1)
            detail::store_byte(packed + product::packed_elements,
                               static_cast<double>(product::arrays.read_ranges(folded).input.zero_point));
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t* memory) noexcept {
        product::run(packed, in, out, memory);
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t* memory, auto& state) noexcept {
        const int zero = detail::load_byte(packed + product::packed_elements);
        alignas(vector_alignment) std::array<In, pad_to_cache_line<In>(Taps * stride)> inputs{};
        for (std::size_t tap = 0; tap + 1 < Taps; ++tap)
            for (std::size_t f = 0; f < Features; ++f)
                inputs[tap * stride + f] = static_cast<In>(state.before(tap)[f] + zero);
        const auto* const present = reinterpret_cast<const In*>(in);
        std::copy_n(present, Features, inputs.data() + (Taps - 1) * stride);
        In* const kept = state.replace_oldest();
        for (std::size_t f = 0; f < Features; ++f)
            kept[f] = static_cast<In>(present[f] - zero);
        product::run(packed, reinterpret_cast<const std::uint8_t*>(inputs.data()), out, memory);
    }
};

namespace detail {

/// The cell of a layer in integers.
template <class Cell>
struct word_cell;
template <>
struct word_cell<gru_cell> : kernels::word_gru_cell {};
template <>
struct word_cell<lstm_cell> : kernels::word_lstm_cell {};

} // namespace detail

/// Recurrent layers in 8 bits: two products and the cells. States have 16 bits; the bytes that are their
/// output and the product's input have a fixed range.
template <class In, class Out, class Cell, std::size_t Features, std::size_t Hidden>
struct recurrent_step<eight_bit_between<In, Out>, Cell, Features, Hidden>
    : step_base<eight_bit, shape{1, 1, Hidden}, detail::frame_stride(Hidden)> {
private:
    using cells = kernels::word_cells<detail::word_cell<Cell>, Hidden>;
    static constexpr std::size_t rows = Cell::gates * Hidden;
    using input_product = detail::frames_product<eight_bit_between<In, float>, 1, Features, rows>;
    using hidden_product = detail::frames_product<eight_bit_between<std::uint8_t, float>, 1, Hidden, rows>;
    static constexpr std::size_t room = // floats
        pad_to_cache_line(std::max(cells::sums, input_product::output_stride));

public:
    static constexpr std::size_t number_elements = sizeof(Out);
    static constexpr std::size_t folded_elements =
                                     input_product::folded_elements + hidden_product::folded_elements,
                                 packed_elements =
                                     input_product::packed_elements + hidden_product::packed_elements,
                                 workspace_elements = std::max(input_product::workspace_elements,
                                                               hidden_product::workspace_elements);
    /// The bytes of hidden states.
    static constexpr map_range output_range{1.0F / kernels::cell_numbers::hidden_steps,
                                            kernels::cell_numbers::hidden_zero};

    /// Zero before the first frame.
    struct state {
        std::array<std::int16_t, detail::word_cell<Cell>::states * cells::units> elements{};
    };

    /// The steps whose folded numbers it has, in order.
    static constexpr void visit_parts(auto&& to) {
        to(inner_step<input_product, step_composition::wrapper>{"frame"},
           inner_step<hidden_product, step_composition::wrapper>{"state"});
    }
    /// From both matrices, then both biases.
    static void fold(const float* values, float* folded) {
        constexpr std::size_t input_weights = input_product::weights,
                              hidden_weights = hidden_product::weights;
        float* const hidden = folded + input_product::folded_elements;
        std::copy_n(values, input_weights, folded);
        std::copy_n(values += input_weights, hidden_weights, hidden);
        std::copy_n(values += hidden_weights, rows, folded + input_weights);
        std::copy_n(values + rows, rows, hidden + hidden_weights);
    }
    static constexpr void set_ranges(float* folded, const step_ranges& ranges) {
        input_product::set_ranges(folded, {ranges.input, {}, {}});
        hidden_product::set_ranges(folded + input_product::folded_elements, {output_range, {}, {}});
    }
    static constexpr void pack(const float* folded, std::int8_t* packed) {
        input_product::pack(folded, packed);
        hidden_product::pack(folded + input_product::folded_elements,
                             packed + input_product::packed_elements);
    }
    static void run(const std::int8_t* packed, const std::uint8_t* in, std::uint8_t* out,
                    std::uint8_t* memory, state& s) noexcept {
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
            std::copy_n(hidden.data(), recurrent_step::output_stride, out);
        }
    }
};

}} // namespace tactnet
