#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/simd/row_vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

// The two passes of a separable resize whose weights are compile-time constants. An `Axis` (see
// image/resize_kernel.hpp) has `inputs`, `outputs`, `taps` and, in `table`, the first input and the weights
// of each output.
//
// The pass down the rows multiplies whole rows by a weight and adds them. In the pass along the rows, a
// vector of outputs is the sum over all inputs that any of them needs, each broadcast and multiplied by a
// vector of weights, most of them zero: images are too small for gathers or transposes to pay off.
//
// Zero times NaN is NaN: `Guarded` passes never multiply by a weight of zero, and are otherwise bit-identical
// with the others.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Whether all of `Count` elements are finite, and so small that 64 of them can be added in any order.
template <std::size_t Count>
[[nodiscard]] [[gnu::flatten]] bool all_addable(const float* from) {
    if constexpr (Count < min_lanes<float>) {
        return std::all_of(from, from + Count, [](float x) { return x * 64 - x * 64 == 0; });
    } else {
        constexpr std::size_t width = lanes_for<float>(Count);
        using wide = sized_vector<float, width>;
        wide rest(0);
        for (std::size_t v = 0; v < row_vectors(Count, width); ++v) {
            const wide large = load_unaligned<wide>(from + row_vector_begin(v, Count, width)) * wide(64);
            rest = rest + (large - large);
        }
        return all_finite(rest);
    }
}

namespace detail {
/// How many outputs from `first` on use the same inputs, at most `most`.
template <class Axis>
[[nodiscard]] std::size_t outputs_alike(std::size_t first, std::size_t most) {
    std::size_t count = 1;
    while (count < most && first + count < Axis::outputs &&
           Axis::table[first + count].first == Axis::table[first].first)
        ++count;
    return count;
}
} // namespace detail

/// Computes `Axis::outputs` rows of `Columns` elements from `Axis::inputs` rows. Memory after rows shorter
/// than a vector must be readable.
template <class Axis, std::size_t Columns, std::size_t FromStride, std::size_t ToStride, bool Guarded>
[[gnu::flatten]] void resample_down(const float* from, float* to) {
    constexpr std::size_t width = row_lanes<float>(Columns), vectors = row_vectors(Columns, width);
    using wide = sized_vector<float, width>;
    const auto each_vector = [&](auto&& body) {
        for (std::size_t v = 0; v < vectors; ++v)
            body(row_vector_begin(v, Columns, width));
    };
    const auto store_row = [&](std::size_t o, std::size_t begin, const wide& values) {
        store_in_row<Columns, width>(to + o * ToStride + begin, values);
    };
    if constexpr (Guarded || 2 * Axis::taps > vector_registers) {
        for (std::size_t o = 0; o < Axis::outputs; ++o) {
            const auto& taps = Axis::table[o];
            each_vector([&](std::size_t begin) {
                const float* const at = from + taps.first * FromStride + begin;
                wide sum(0);
                for (std::size_t t = 0; t < Axis::taps; ++t)
                    if (!Guarded || taps.weights[t] != 0)
                        sum = fused_multiply_add(load_unaligned<wide>(at + t * FromStride),
                                                 wide(taps.weights[t]), sum);
                store_row(o, begin, sum);
            });
        }
    } else {
        const auto together = [&](auto count, std::size_t o) {
            constexpr std::size_t rows = count;
            std::array<std::array<wide, Axis::taps>, rows> weights;
#pragma GCC unroll 64
            for (std::size_t r = 0; r < rows; ++r) {
#pragma GCC unroll 64
                for (std::size_t t = 0; t < Axis::taps; ++t)
                    weights[r][t] = wide(Axis::table[o + r].weights[t]);
            }
            each_vector([&](std::size_t begin) {
                const float* const at = from + Axis::table[o].first * FromStride + begin;
                // Starts at zero: a compiler that fuses a · b + c · d may choose either product.
                std::array<wide, rows> sums;
#pragma GCC unroll 64
                for (std::size_t r = 0; r < rows; ++r)
                    sums[r] = wide(0);
#pragma GCC unroll 64
                for (std::size_t t = 0; t < Axis::taps; ++t) {
                    const wide input = load_unaligned<wide>(at + t * FromStride);
#pragma GCC unroll 64
                    for (std::size_t r = 0; r < rows; ++r)
                        sums[r] = fused_multiply_add(input, weights[r][t], sums[r]);
                }
#pragma GCC unroll 64
                for (std::size_t r = 0; r < rows; ++r)
                    store_row(o + r, begin, sums[r]);
            });
        };
        // Neighbours that use the same inputs are computed together, so that these are loaded once.
        constexpr std::size_t most = std::min<std::size_t>(vector_registers / 2 / Axis::taps, Axis::outputs);
        for (std::size_t o = 0; o < Axis::outputs;)
            if (detail::outputs_alike<Axis>(o, most) == most)
                together(constant<most>{}, o), o += most;
            else
                together(constant<1>{}, o), ++o;
    }
}

/// The weights along the rows: for each vector of `Lanes` outputs, the weights of each input from `first` on.
template <class Axis, std::size_t Lanes>
struct weight_bands {
    static constexpr std::size_t count = row_vectors(Axis::outputs, Lanes);

    struct band {
        std::size_t begin = 0, outputs = 0, first = Axis::inputs, span = 0, weights = 0;
    };
    static constexpr std::array<band, count> table = [] {
        std::array<band, count> all{};
        std::size_t total = 0;
        for (std::size_t b = 0; b < count; ++b) {
            band& each = all[b];
            each.begin = row_vector_begin(b, Axis::outputs, Lanes);
            each.outputs = std::min(Lanes, Axis::outputs);
            std::size_t end = 0;
            for (std::size_t o = each.begin; o < each.begin + each.outputs; ++o) {
                const auto& taps = Axis::table[o];
                for (std::size_t t = 0; t < Axis::taps; ++t)
                    if (taps.weights[t] != 0) {
                        each.first = std::min(each.first, taps.first + t);
                        end = std::max(end, taps.first + t + 1);
                    }
            }
            each.span = end - each.first;
            each.weights = total * Lanes;
            total += each.span;
        }
        return all;
    }();
    /// Multiply-adds of vectors for one row.
    static constexpr std::size_t products = table.back().weights / Lanes + table.back().span;
    /// Their cost: registers of 64 bytes count twice.
    static constexpr std::size_t cost = products * (Lanes * sizeof(float) == 64 ? 2 : 1);

    alignas(vector_alignment) static constexpr std::array<float, products* Lanes> weights = [] {
        std::array<float, products * Lanes> all{};
        for (const band& each : table)
            for (std::size_t lane = 0; lane < each.outputs; ++lane) {
                const auto& taps = Axis::table[each.begin + lane];
                for (std::size_t t = 0; t < Axis::taps; ++t)
                    if (taps.weights[t] != 0)
                        all[each.weights + (taps.first + t - each.first) * Lanes + lane] = taps.weights[t];
            }
        return all;
    }();
};

namespace detail {
template <class Axis, std::size_t Lanes>
constexpr auto narrowed_bands() {
    if constexpr (Lanes > min_lanes<float>) {
        using narrower = decltype(narrowed_bands<Axis, Lanes / 2>());
        if constexpr (narrower::type::cost < weight_bands<Axis, Lanes>::cost)
            return narrower{};
        else
            return std::type_identity<weight_bands<Axis, Lanes>>{};
    } else {
        return std::type_identity<weight_bands<Axis, Lanes>>{};
    }
}
} // namespace detail
template <class Axis>
using cheapest_bands = typename decltype(detail::narrowed_bands<Axis, lanes<float>>())::type;

/// Computes `Rows` rows of `Axis::outputs` elements from as many rows of `Axis::inputs`.
template <class Axis, std::size_t Rows, std::size_t FromStride, std::size_t ToStride, bool Guarded>
[[gnu::flatten]] void resample_along(const float* from, float* to) {
    using bands = cheapest_bands<Axis>;
    constexpr std::size_t width = bands::weights.size() / bands::products;
    using wide = sized_vector<float, width>;
    // As many rows together as registers hold and as hide the latency, in blocks of nearly the same size.
    constexpr std::size_t most = std::min<std::size_t>(vector_registers - 4, 14),
                          blocks = ceil_div(Rows, most);
    for (const auto& band : bands::table)
        blocked<Rows, ceil_div(Rows, blocks)>([&](auto count, std::size_t row) {
            constexpr std::size_t rows = count;
            std::array<wide, rows> sums;
#pragma GCC unroll 64
            for (std::size_t r = 0; r < rows; ++r)
                sums[r] = wide(0);
            const float* const source = from + row * FromStride + band.first;
            const float* const weights = bands::weights.data() + band.weights;
            for (std::size_t i = 0; i < band.span; ++i) {
                const wide weight = load_as<wide>(weights + i * width);
#pragma GCC unroll 64
                for (std::size_t r = 0; r < rows; ++r) {
                    const wide sum = fused_multiply_add(wide(source[r * FromStride + i]), weight, sums[r]);
                    if constexpr (Guarded)
                        sums[r] = select_if_zero(weight, sums[r], sum);
                    else
                        sums[r] = sum;
                }
            }
#pragma GCC unroll 64
            for (std::size_t r = 0; r < rows; ++r)
                store_in_row<Axis::outputs, width>(to + (row + r) * ToStride + band.begin, sums[r]);
        });
}

}}} // namespace tactnet::kernels
