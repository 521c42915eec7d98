#pragma once

#include <tactnet/kernels/arch/compiler_vector.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

// What an instruction set gives to the kernels, here in plain C++. Each file of this folder has the struct of
// one instruction set, derived from that below it, which replaces what there are instructions for.
// selected.hpp takes the best.
//
// sums += weights · inputs in integers: signed weights of 8 bits times inputs of 8 or 16 bits, exactly, in
// sums of 32 bits. An instruction multiplies a `group` of neighbouring inputs, broadcast to all lanes, by as
// many weights of one filter per lane: [filter][input of the group]. Every intermediate sum has 32 bits, so
// nothing saturates.
//
// clang-format off
// Members of words<Lanes>, the products for inputs of 16 bits, and bytes<Lanes>, those for unsigned inputs of 8 bits:
//   staged    the type of inputs in memory while they are multiplied
//   weight    the type of weights: 16 bits if inputs have 16, since widening takes as long as a product
//   group     inputs per instruction
//   offset    subtracted from an input of 8 bits as it is staged
//   order     optional: the input that each weight of a group belongs to, if in another order
//   max_sums  optional: sums that stay in registers, if fewer than of floats
// clang-format on

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels { namespace arch {

/// The rank of an instruction set among those of a processor.
template <int Rank>
struct rank : rank<Rank - 1> {};
template <>
struct rank<0> {};

/// Products of one input per instruction, by any compiler.
template <std::size_t Lanes>
struct plain_products {
    using staged = std::int16_t;
    using weight = std::int8_t;
    using weights = int32_vec<Lanes>;
    using inputs = std::int32_t;
    static constexpr std::size_t group = 1;
    static constexpr int offset = 0;

    [[gnu::always_inline]] static weights load(const std::int8_t* from) {
        weights w = weights{} + from[0]; // GCC 12 takes a vector written lane by lane for uninitialised
        for (std::size_t lane = 1; lane < Lanes; ++lane)
            w[lane] = from[lane];
        return w;
    }
    [[gnu::always_inline]] static inputs broadcast(const staged* from) { return *from; }
    [[gnu::always_inline]] static int32_vec<Lanes> add(const int32_vec<Lanes>& sums, const weights& w,
                                                       const inputs& x) {
        return sums + w * x;
    }
};

/// Products of groups that fill 32 bits; a set adds `add`.
template <std::size_t Lanes, class Staged, class Weight>
struct group_products {
    using staged = Staged;
    using weight = Weight;
    using weights = int32_vec<Lanes>;
    using inputs = int32_vec<Lanes>;
    static constexpr std::size_t group = sizeof(std::int32_t) / sizeof(Weight);
    static constexpr int offset = 0;

    [[gnu::always_inline]] static weights load(const Weight* from) { return load_bytes_as<weights>(from); }
    [[gnu::always_inline]] static inputs broadcast(const Staged* from) {
        return load_bytes_as<std::int32_t>(from) - inputs{};
    }
};

/// Keeps the low halves of the elements: within each 16 bytes those of a, then those of b.
template <class Vector, std::size_t... I>
[[gnu::always_inline]] inline Vector low_halves(const Vector& a, const Vector& b, std::index_sequence<I...>) {
    constexpr std::size_t n = sizeof...(I), row = 16 * n / sizeof(Vector);
    return __builtin_shufflevector(
        a, b, static_cast<int>(I / row * row + I % (row / 2) * 2 + I % row / (row / 2) * n)...);
}

struct scalar {
    /// Lanes of the widest vector of 32-bit integers that the instruction set multiplies.
    static constexpr std::size_t integer_lanes = 1;
    static constexpr std::size_t vector_registers = 16;
    /// Whether a block of integer sums adds the products of one weight after the other, or of one row of
    /// inputs.
    static constexpr bool weight_by_weight = false;
    /// Lanes of a vector of floats, if there are such vectors and xsimd has none.
    static constexpr std::size_t float_lanes = 1;
    /// Lanes of the widest vector of 32-bit integers that are rounded to bytes together.
    static constexpr std::size_t rounded_lanes = 1;
    /// Whether one instruction shuffles the bytes of a vector, and none converts integers to bytes.
    static constexpr bool shuffles_bytes = false;
    /// Instructions for the products of a group of words and their addition to the sums.
    static constexpr std::size_t word_product_cost = 2;

    template <std::size_t Lanes>
    using words = plain_products<Lanes>;
    template <std::size_t Lanes>
    using bytes = words<Lanes>;

    /// Converts bytes to 16-bit integers.
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static int16_vec<Lanes> to_int16(const uint8_vec<Lanes>& values) {
        return __builtin_convertvector(values, int16_vec<Lanes>);
    }
    /// Converts bytes to 32-bit integers. In two steps where there is no instruction: GCC 12 converts lane by
    /// lane if the size of an element more than doubles.
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static int32_vec<Lanes> to_int32(const uint8_vec<Lanes>& values) {
        return __builtin_convertvector(to_int16<Lanes>(values), int32_vec<Lanes>);
    }
    /// a · b + c of such vectors; b may be one number for all lanes.
    template <class Floats, class Factor>
    [[nodiscard]] [[gnu::always_inline]] static Floats multiply_add(const Floats& a, const Factor& b,
                                                                    const Floats& c) {
        return a * b + c;
    }
    /// The larger of both; `b` if one is NaN.
    template <class Floats>
    [[nodiscard]] [[gnu::always_inline]] static Floats larger(const Floats& a, const Floats& b) {
        return a > b ? a : b;
    }
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static float_vec<Lanes> to_float(const int32_vec<Lanes>& values) {
        return __builtin_convertvector(values, float_vec<Lanes>);
    }
    /// Clamps to a range; NaN becomes its least.
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static float_vec<Lanes> clamp(float_vec<Lanes> values, float lowest,
                                                                       float highest) {
        const float_vec<Lanes> least = lowest - float_vec<Lanes>{}, most = highest - float_vec<Lanes>{};
        values = values > least ? values : least;
        values = values < most ? values : most;
        return values;
    }
    /// The last 8 bits of each integer.
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static uint8_vec<Lanes> last_bytes(const int32_vec<Lanes>& whole) {
        return __builtin_convertvector(whole, uint8_vec<Lanes>);
    }
    /// Narrows integers from 0 to 255, in the order of `interleave`, to bytes in their own order.
    template <std::size_t Lanes>
    [[nodiscard]] [[gnu::always_inline]] static uint8_vec<4 * Lanes>
    narrow(const std::array<int32_vec<Lanes>, 4>& whole) {
        const auto pair = [&](std::size_t v) {
            return reinterpret_cast<uint8_vec<4 * Lanes>>(low_halves(
                reinterpret_cast<int16_vec<2 * Lanes>>(whole[v]),
                reinterpret_cast<int16_vec<2 * Lanes>>(whole[v + 1]), std::make_index_sequence<2 * Lanes>{}));
        };
        return low_halves(pair(0), pair(2), std::make_index_sequence<4 * Lanes>{});
    }
};
scalar set_of(rank<0>);

}}}} // namespace tactnet::kernels::arch
