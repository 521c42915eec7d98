#pragma once

#include <tactnet/kernels/frame/dense.hpp>
#include <tactnet/lowering/step.hpp>
#include <tactnet/operators/recurrent/cells.hpp>

#include <array>
#include <cstddef>
#include <cstring>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A recurrent layer of a cell (operators/recurrent/cells.hpp) on one frame of a stream.
template <class Format, class Cell, std::size_t Features, std::size_t Hidden>
struct recurrent_step;
template <class Format, class Cell, std::size_t Features, std::size_t Hidden>
struct step_description<recurrent_step<Format, Cell, Features, Hidden>> {
    static constexpr const char* header = "tactnet/operators/recurrent/step.hpp";
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

}} // namespace tactnet
