#pragma once

// Only what the processor may have is read.
#if defined(__SSE2__)
#include <tactnet/kernels/arch/vnni.hpp>
#elif defined(__aarch64__)
#include <tactnet/kernels/arch/matrix_product.hpp>
#elif defined(__wasm__)
#include <tactnet/kernels/arch/wasm.hpp>
#else
#include <tactnet/kernels/arch/arm_dsp.hpp>
#include <tactnet/kernels/arch/helium.hpp>
#endif

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The best instruction set that this unit is compiled for. scalar.hpp describes the members.
using instructions = decltype(arch::set_of(arch::rank<9>{}));

inline constexpr std::size_t max_integer_lanes = instructions::integer_lanes;
template <std::size_t Lanes>
using word_products = typename instructions::template words<Lanes>;
template <std::size_t Lanes>
using byte_products = typename instructions::template bytes<Lanes>;

/// Lanes of the widest vector of bytes that divides `count`.
[[nodiscard]] constexpr std::size_t widest_bytes(std::size_t count) {
    std::size_t width = 4 * max_integer_lanes;
    while (count % width != 0)
        width /= 2;
    return width;
}

}}} // namespace tactnet::kernels
