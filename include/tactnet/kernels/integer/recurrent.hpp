#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/selected.hpp>
#include <tactnet/kernels/integer/rounding.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

// The cells of recurrent layers in integers. Products read hidden states as bytes, states keep 16 bits. Gates
// and hidden states are multiples of 1/32768; sums and the content of an LSTM are multiples of 1/2048, up to
// ±16. A product of two such numbers fits 32 bits and is rounded to the nearest; sigmoid and tanh are
// computed from integers and rounded once. No product of floats is added to anything, so all instruction sets
// give the same bits.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The formats of the 16-bit numbers in cells.
struct cell_numbers {
    static constexpr int gate_bits = 15, sum_bits = 11; ///< after the point
    static constexpr std::int32_t most = 32767;         ///< the largest magnitude
    /// A hidden state as a byte, for products and the next layer: (byte − 128) ÷ 127, from 1 to 255.
    static constexpr std::int32_t hidden_steps = 127, hidden_zero = 128;
};

namespace detail {

/// Values clamped to ±Most.
template <std::size_t Lanes, std::int32_t Most = cell_numbers::most>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes> clamped(int32_vec<Lanes> values) {
    const int32_vec<Lanes> most = Most + int32_vec<Lanes>{}, least = -most;
    values = values < most ? values : most;
    return values > least ? values : least;
}
/// a · b ÷ 2^Bits, rounded; a · b has 32 bits. Scaling by a power of two is exact.
template <std::size_t Lanes, int Bits>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes> scaled_product(const int32_vec<Lanes>& a,
                                                                            const int32_vec<Lanes>& b) {
    constexpr float scale = 1.0F / static_cast<float>(1 << Bits);
    return nearest<Lanes>(__builtin_convertvector(a * b, float_vec<Lanes>) * scale);
}

/// `top` ÷ (1 + e^−x) for magnitudes of x up to `most` ÷ 2048, rounded to an integer. With t = x · log₂ e,
/// e^−x is 2 to the power of −u, where u is t's fraction, times a power of two. The cubic polynomial in u is
/// within 6.4e-5 of the former, and exact at 0; a product of integers of 16 bits and a coefficient is rounded
/// in each of its steps.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes> logistic(const int32_vec<Lanes>& x, float top) {
    using integers = int32_vec<Lanes>;
    constexpr int fraction_bits = 26, bits = 15, float_bits = 23;
    constexpr std::int32_t one = 1 << bits, half = one / 2, log2_of_e = 47274; // · 2²⁶ ÷ 2048
    const integers t = x * log2_of_e;
    const integers u = (t >> (fraction_bits - bits)) & (one - 1);
    integers p = -1316 + integers{};
    for (const std::int32_t coefficient : {std::int32_t{7600}, std::int32_t{-22670}, one})
        p = (p * u + (coefficient * one + half)) >> bits;
    // Dividing a float by a power of two is a subtraction from its exponent.
    const float_vec<Lanes> power_of_fraction = __builtin_convertvector(p, float_vec<Lanes>);
    const integers power = load_bytes_as<integers>(&power_of_fraction) - ((t >> fraction_bits) << float_bits);
    return nearest<Lanes>(top * one / (one + load_bytes_as<float_vec<Lanes>>(&power)));
}
/// sigmoid(x ÷ 2048) · 32768, from 0 to 32768, within 1.9. `x` may be the sum of two sums.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes> sigmoid_of_sum(const int32_vec<Lanes>& x) {
    return logistic<Lanes>(clamped<Lanes>(x), 32768);
}
/// tanh(x ÷ 2048) · 32768 = 65536 · sigmoid(2 x ÷ 2048) − 32768, from −32767 to 32767, within 3.1.
template <std::size_t Lanes>
[[nodiscard]] [[gnu::always_inline]] inline int32_vec<Lanes> tanh_of_sum(const int32_vec<Lanes>& x) {
    constexpr std::int32_t within_one = 24000; // what is larger would be rounded to ±32768
    return logistic<Lanes>(clamped<Lanes, within_one>(2 * x), 65536) - 32768;
}

} // namespace detail

/// The cell of a gated recurrent unit: gates r, z, n, and the hidden state. operators/temporal/cells.hpp
/// has the formulas.
struct word_gru_cell {
    static constexpr std::size_t gates = 3, states = 1;

    template <std::size_t Lanes>
    [[gnu::always_inline]] static void update(const std::array<int32_vec<Lanes>, 3>& in,
                                              const std::array<int32_vec<Lanes>, 3>& hidden,
                                              std::array<int32_vec<Lanes>, 1>& state) {
        constexpr int bits = cell_numbers::gate_bits;
        const int32_vec<Lanes> r = detail::sigmoid_of_sum<Lanes>(in[0] + hidden[0]),
                               z = detail::sigmoid_of_sum<Lanes>(in[1] + hidden[1]);
        const int32_vec<Lanes> n =
            detail::tanh_of_sum<Lanes>(in[2] + detail::scaled_product<Lanes, bits>(r, hidden[2]));
        state[0] = n + detail::scaled_product<Lanes, bits>(z, state[0] - n);
    }
};

/// The cell of a long short-term memory: gates i, f, g, o, the hidden state and the content, which saturates
/// at ±16. operators/temporal/cells.hpp has the formulas.
struct word_lstm_cell {
    static constexpr std::size_t gates = 4, states = 2;

    template <std::size_t Lanes>
    [[gnu::always_inline]] static void update(const std::array<int32_vec<Lanes>, 4>& in,
                                              const std::array<int32_vec<Lanes>, 4>& hidden,
                                              std::array<int32_vec<Lanes>, 2>& state) {
        constexpr int bits = cell_numbers::gate_bits, to_content = 2 * bits - cell_numbers::sum_bits;
        const int32_vec<Lanes> i = detail::sigmoid_of_sum<Lanes>(in[0] + hidden[0]),
                               f = detail::sigmoid_of_sum<Lanes>(in[1] + hidden[1]),
                               g = detail::tanh_of_sum<Lanes>(in[2] + hidden[2]),
                               o = detail::sigmoid_of_sum<Lanes>(in[3] + hidden[3]);
        state[1] = detail::clamped<Lanes>(detail::scaled_product<Lanes, bits>(f, state[1]) +
                                          detail::scaled_product<Lanes, to_content>(i, g));
        state[0] = detail::scaled_product<Lanes, bits>(o, detail::tanh_of_sum<Lanes>(state[1]));
    }
};

/// `Hidden` units of a cell.
template <class Cell, std::size_t Hidden>
struct word_cells {
    static constexpr std::size_t lanes = max_integer_lanes;
    static constexpr std::size_t units = round_up(Hidden, lanes); ///< of a state and of the bytes, in vectors
    /// Floats of all gates; the last vector may end after the last gate.
    static constexpr std::size_t sums = (Cell::gates - 1) * Hidden + units;

    /// Updates the states [state][unit] by the gates' sums over the input and over the hidden state, each
    /// [gate][unit], and writes the hidden state as bytes.
    [[gnu::flatten]] static void update(const float* in, const float* hidden, std::int16_t* states,
                                        std::uint8_t* bytes) noexcept {
        for (std::size_t unit = 0; unit < units; unit += lanes) {
            std::array<int32_vec<lanes>, Cell::states> state;
            for (std::size_t s = 0; s < Cell::states; ++s)
                state[s] = __builtin_convertvector(load_bytes_as<int16_vec<lanes>>(states + s * units + unit),
                                                   int32_vec<lanes>);
            Cell::template update<lanes>(load_sums(in + unit), load_sums(hidden + unit), state);
            for (std::size_t s = 0; s < Cell::states; ++s)
                store_any(states + s * units + unit, __builtin_convertvector(state[s], int16_vec<lanes>));
            store_hidden(bytes + unit, state[0]);
        }
    }
    /// Writes the hidden state as bytes.
    static void write_bytes(const std::int16_t* states, std::uint8_t* bytes) noexcept {
        for (std::size_t unit = 0; unit < units; unit += lanes)
            store_hidden(bytes + unit, __builtin_convertvector(load_bytes_as<int16_vec<lanes>>(states + unit),
                                                               int32_vec<lanes>));
    }

private:
    using vectors = std::array<int32_vec<lanes>, Cell::gates>;

    [[nodiscard]] [[gnu::always_inline]] static vectors load_sums(const float* from) {
        constexpr float steps = 1 << cell_numbers::sum_bits, limit = cell_numbers::most;
        const float_vec<lanes> most = limit + float_vec<lanes>{};
        vectors all;
        for (std::size_t gate = 0; gate < Cell::gates; ++gate) {
            float_vec<lanes> x = load_bytes_as<float_vec<lanes>>(from + gate * Hidden) * steps;
            x = x < most ? x : most;
            x = x > -most ? x : -most;
            all[gate] = nearest<lanes>(x);
        }
        return all;
    }
    [[gnu::always_inline]] static void store_hidden(std::uint8_t* to, const int32_vec<lanes>& state) {
        constexpr float step = cell_numbers::hidden_steps / 32768.0F;
        store_rounded<lanes>(to, state, step + float_vec<lanes>{}, {1, 255, cell_numbers::hidden_zero});
    }
};

}}} // namespace tactnet::kernels
