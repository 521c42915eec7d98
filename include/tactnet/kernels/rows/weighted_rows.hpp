#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/arch/compiler_vector.hpp>
#include <tactnet/kernels/simd/sized_vector.hpp>
#include <tactnet/kernels/simd/unroll.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// sums[c] += Σ weights[r] · rows[r · Columns + c], over `Rows` rows of `Columns` floats, of any alignment.
template <std::size_t Rows, std::size_t Columns>
[[gnu::flatten]] void add_weighted_rows(const float* weights, const float* rows, float* sums) noexcept {
    constexpr std::size_t width = std::min(std::bit_floor(Columns), lanes<float>);
    constexpr std::size_t count = ceil_div(Columns, width), most = std::min<std::size_t>(count, 4);
    using vector = float_vec<width>;
    // The last vector may begin amid the one before it: it then computes some of its sums once more.
    std::array<float, Columns> found;
    blocked<count, most>([&](auto block, std::size_t first) {
        constexpr std::size_t vectors = block, chains = std::max<std::size_t>(8 / vectors, 1);
        const auto column = [&](std::size_t v) { return std::min((first + v) * width, Columns - width); };
        register_block<vector, chains, vectors> parts{};
        const auto add = [&](std::size_t chain, std::size_t r) __attribute__((always_inline)) {
#pragma GCC unroll 8
            for (std::size_t v = 0; v < vectors; ++v)
                parts[chain][v] += weights[r] * load_bytes_as<vector>(rows + r * Columns + column(v));
        };
        for (std::size_t r = 0; r + chains <= Rows; r += chains) { // chains of additions hide their latency
#pragma GCC unroll 8
            for (std::size_t chain = 0; chain < chains; ++chain)
                add(chain, r + chain);
        }
#pragma GCC unroll 8
        for (std::size_t r = Rows / chains * chains; r < Rows; ++r)
            add(r % chains, r);
#pragma GCC unroll 8
        for (std::size_t v = 0; v < vectors; ++v) {
            vector sum{};
#pragma GCC unroll 8
            for (std::size_t chain = 0; chain < chains; ++chain)
                sum += parts[chain][v];
            store_any(found.data() + column(v), sum);
        }
    });
    for (std::size_t c = 0; c < Columns; ++c)
        sums[c] += found[c];
}

}}} // namespace tactnet::kernels
