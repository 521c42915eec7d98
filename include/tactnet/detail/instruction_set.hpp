#pragma once

#include <tactnet/detail/config.hpp>

#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

#define TACTNET_ARCH_TEXT_OF(number) #number
#define TACTNET_ARCH_TEXT(number) TACTNET_ARCH_TEXT_OF(number)

/// The instruction set that this unit is compiled for, spelled out: for example "simd_avx2_fma_bmi2_lzcnt",
/// or "scalar_sse2" without vectors. Results are labelled with it; TACTNET_ARCH is its short form. If a
/// program built for a current x86-64 prints "simd_sse2", it was compiled without -march.
inline constexpr std::string_view instruction_set =
#if defined(TACTNET_NO_SIMD)
    "scalar"
#else
    "simd"
#endif
#if defined(__AVX512F__)
    "_avx512f"
#elif defined(__AVX2__)
    "_avx2"
#elif defined(__AVX__)
    "_avx"
#elif defined(__SSE4_2__)
    "_sse42"
#elif defined(__SSE4_1__)
    "_sse41"
#elif defined(__SSSE3__)
    "_ssse3"
#elif defined(__SSE3__)
    "_sse3"
#elif defined(__SSE2__)
    "_sse2"
#elif defined(__ARM_FEATURE_SVE) && __ARM_FEATURE_SVE_BITS > 0
    "_sve" TACTNET_ARCH_TEXT(__ARM_FEATURE_SVE_BITS)
#elif defined(__ARM_FEATURE_SVE)
    "_sve"
#elif defined(__aarch64__)
    "_neon64"
#elif defined(__wasm_simd128__)
    "_wasm128"
#endif
    TACTNET_ARCH_IF(__FMA__, "_fma") TACTNET_ARCH_IF(__FMA4__, "_fma4") TACTNET_ARCH_IF(__BMI2__, "_bmi2")
        TACTNET_ARCH_IF(__LZCNT__, "_lzcnt") TACTNET_ARCH_IF(__AVX512CD__, "_cd")
            TACTNET_ARCH_IF(__AVX512DQ__, "_dq") TACTNET_ARCH_IF(__AVX512BW__, "_bw")
                TACTNET_ARCH_IF(__AVX512VL__, "_vl") TACTNET_ARCH_IF(__AVX512VBMI__, "_vbmi")
                    TACTNET_ARCH_IF(__AVX512VNNI__, "_vnni") TACTNET_ARCH_IF(__AVXVNNI__, "_avxvnni")
                        TACTNET_ARCH_IF(__ARM_FEATURE_DOTPROD, "_dotprod")
#if defined(__arm__)
                            TACTNET_ARCH_IF(__ARM_FEATURE_DSP, "_dsp")
#endif
#if !defined(TACTNET_L1_CACHE_BY_DEFAULT)
                                "_l1_" TACTNET_ARCH_TEXT(TACTNET_L1_CACHE_KIB)
#endif
#if !defined(TACTNET_L2_CACHE_BY_DEFAULT)
                                    "_l2_" TACTNET_ARCH_TEXT(TACTNET_L2_CACHE_KIB)
#endif
    ;

#undef TACTNET_ARCH_TEXT
#undef TACTNET_ARCH_TEXT_OF

}} // namespace tactnet
