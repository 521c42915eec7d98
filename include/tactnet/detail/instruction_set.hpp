#pragma once

#include <tactnet/detail/config.hpp>

#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The instruction set that this unit is compiled for, spelled out: for example "simd_avx2_fma_bmi2_lzcnt",
/// or "scalar_sse2" without vectors. Results are labelled with it; TACTNET_ARCH is its short form. If a
/// program built for a current x86-64 prints "simd_sse2", it was compiled without -march.
inline constexpr std::string_view instruction_set = TACTNET_ARCH_EXTENSIONS(
    TACTNET_ARCH_ADD_LONG, TACTNET_ARCH_KIND(TACTNET_ARCH_LONG) TACTNET_ARCH_LEVEL(TACTNET_ARCH_LONG))
    TACTNET_ARCH_TEXT(TACTNET_ARCH_L1) TACTNET_ARCH_TEXT(TACTNET_ARCH_L2);

}} // namespace tactnet
