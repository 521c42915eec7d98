#pragma once

#include <tactnet/version.hpp>

// Their libraries lack parts of C++20 that they promise.
#if __cplusplus < 202002L || (defined(__clang__) ? __clang_major__ < 14 : defined(__GNUC__) && __GNUC__ < 12)
#error "tactnet needs C++20: GCC 12, Clang 14 or newer with -std=c++20"
// A missing file stops the compilation, so that the sentence above is the last one.
#include <tactnet_needs_cxx20>
#endif

// The promise that a frame with NaN or infinity is never recognised takes comparisons which compilers leave
// out where they may assume that there are no such numbers.
#if defined(__FINITE_MATH_ONLY__) && __FINITE_MATH_ONLY__ != 0
#error                                                                                                       \
    "tactnet checks for NaN and infinity: compile without -ffast-math, or add -fno-finite-math-only after it"
#endif

// The instruction set names an inline namespace around the whole library, for example
// `tactnet::for_avx2fbl`. Translation units built for different instruction sets can therefore be linked into
// one program: the same template, compiled twice, has two names. A function that takes a type of the library
// must be defined in a unit built for the same set: where the linker reports an undefined reference to
// `…for_avx2fbl…`, the unit with the definition was compiled with other flags.
//
// The name covers all that changes the layout of vectors, the choices of xsimd, or the instructions that a
// compiler adds by itself: a level of SSE, AVX, NEON or SVE, then a letter per extension. It does not cover
// the version of xsimd, of which a program has one, nor templates outside this namespace: those of the
// standard library, and of Eigen in eigen.hpp and simulation/effects/circuit/resistive_network.hpp, which
// belong into units of one instruction set. `instruction_set` (detail/instruction_set.hpp) spells the name
// out.
//
// Configuration: define TACTNET_NO_SIMD to build without vector instructions. It is defined automatically
// where xsimd has no vectors of both float and double: they need SSE2, 64-bit ARM or WebAssembly's SIMD.
#if !defined(TACTNET_NO_SIMD) && !defined(__SSE2__) && !defined(__aarch64__) && !defined(__wasm_simd128__)
#define TACTNET_NO_SIMD
#endif

#if defined(TACTNET_NO_SIMD)
#define TACTNET_ARCH_KIND for_scalar_
#else
#define TACTNET_ARCH_KIND for_
#endif

// A level includes those below it. Vectors of SVE have the length for which they are compiled, if that is
// fixed.
#define TACTNET_ARCH_SVE(bits) TACTNET_ARCH_SVE_JOINED(bits)
#define TACTNET_ARCH_SVE_JOINED(bits) sve##bits
#if defined(__AVX512F__)
#define TACTNET_ARCH_LEVEL avx512
#elif defined(__AVX2__)
#define TACTNET_ARCH_LEVEL avx2
#elif defined(__AVX__)
#define TACTNET_ARCH_LEVEL avx
#elif defined(__SSE4_2__)
#define TACTNET_ARCH_LEVEL sse42
#elif defined(__SSE4_1__)
#define TACTNET_ARCH_LEVEL sse41
#elif defined(__SSSE3__)
#define TACTNET_ARCH_LEVEL ssse3
#elif defined(__SSE3__)
#define TACTNET_ARCH_LEVEL sse3
#elif defined(__SSE2__)
#define TACTNET_ARCH_LEVEL sse2
#elif defined(__ARM_FEATURE_SVE) && __ARM_FEATURE_SVE_BITS > 0
#define TACTNET_ARCH_LEVEL TACTNET_ARCH_SVE(__ARM_FEATURE_SVE_BITS)
#elif defined(__ARM_FEATURE_SVE)
#define TACTNET_ARCH_LEVEL sve
#elif defined(__aarch64__)
#define TACTNET_ARCH_LEVEL neon
#elif defined(__wasm_simd128__)
#define TACTNET_ARCH_LEVEL wasm128
#else
#define TACTNET_ARCH_LEVEL base
#endif

// `text` if a macro of the compiler is 1, and nothing if it is not defined.
#define TACTNET_ARCH_IF(macro, text) TACTNET_ARCH_IF_EXPANDED(macro, text)
#define TACTNET_ARCH_IF_EXPANDED(value, text) TACTNET_ARCH_SECOND(TACTNET_ARCH_COMMA_IF_##value text, , )
#define TACTNET_ARCH_SECOND(...) TACTNET_ARCH_SECOND_OF(__VA_ARGS__)
#define TACTNET_ARCH_SECOND_OF(first, second, ...) second
#define TACTNET_ARCH_COMMA_IF_1 ,

// One letter per extension; capitals where AMD and Intel differ, or for ARM.
#define TACTNET_ARCH_FMA TACTNET_ARCH_IF(__FMA__, f)
#define TACTNET_ARCH_FMA4 TACTNET_ARCH_IF(__FMA4__, F)
#define TACTNET_ARCH_BMI2 TACTNET_ARCH_IF(__BMI2__, b)
#define TACTNET_ARCH_LZCNT TACTNET_ARCH_IF(__LZCNT__, l)
#define TACTNET_ARCH_CD TACTNET_ARCH_IF(__AVX512CD__, c)
#define TACTNET_ARCH_DQ TACTNET_ARCH_IF(__AVX512DQ__, d)
#define TACTNET_ARCH_BW TACTNET_ARCH_IF(__AVX512BW__, w)
#define TACTNET_ARCH_VL TACTNET_ARCH_IF(__AVX512VL__, v)
#define TACTNET_ARCH_VBMI TACTNET_ARCH_IF(__AVX512VBMI__, m)
#define TACTNET_ARCH_VNNI TACTNET_ARCH_IF(__AVX512VNNI__, n)
#define TACTNET_ARCH_AVXVNNI TACTNET_ARCH_IF(__AVXVNNI__, N)
#define TACTNET_ARCH_DOTPROD TACTNET_ARCH_IF(__ARM_FEATURE_DOTPROD, p)
#if defined(__arm__)
#define TACTNET_ARCH_DSP TACTNET_ARCH_IF(__ARM_FEATURE_DSP, s)
#else
#define TACTNET_ARCH_DSP
#endif

// Cache sizes, where they are configured (kernels/caches.hpp), decide how much memory a kernel takes. They
// must be plain numbers, since they become part of the name, and be defined before the first header.
#define TACTNET_ARCH_SIZE_JOINED(name, size) _##name##_##size
#define TACTNET_ARCH_SIZE(name, size) TACTNET_ARCH_SIZE_JOINED(name, size)
#if defined(TACTNET_L1_CACHE_KIB)
#define TACTNET_ARCH_L1 TACTNET_ARCH_SIZE(l1, TACTNET_L1_CACHE_KIB)
#else
#define TACTNET_ARCH_L1
#define TACTNET_L1_CACHE_BY_DEFAULT
#endif
#if defined(TACTNET_L2_CACHE_KIB)
#define TACTNET_ARCH_L2 TACTNET_ARCH_SIZE(l2, TACTNET_L2_CACHE_KIB)
#else
#define TACTNET_ARCH_L2
#define TACTNET_L2_CACHE_BY_DEFAULT
#endif

#define TACTNET_ARCH_JOINED(kind, level, fma, fma4, bmi2, lzcnt, cd, dq, bw, vl, vbmi, vnni, avxvnni,        \
                            dotprod, dsp, l1, l2)                                                            \
    kind##level##fma##fma4##bmi2##lzcnt##cd##dq##bw##vl##vbmi##vnni##avxvnni##dotprod##dsp##l1##l2
// A second macro, so that its arguments are expanded before they are joined.
#define TACTNET_ARCH_JOIN(...) TACTNET_ARCH_JOINED(__VA_ARGS__)
/// For example for_avx2fbl, or for_scalar_sse2.
#define TACTNET_ARCH                                                                                         \
    TACTNET_ARCH_JOIN(TACTNET_ARCH_KIND, TACTNET_ARCH_LEVEL, TACTNET_ARCH_FMA, TACTNET_ARCH_FMA4,            \
                      TACTNET_ARCH_BMI2, TACTNET_ARCH_LZCNT, TACTNET_ARCH_CD, TACTNET_ARCH_DQ,               \
                      TACTNET_ARCH_BW, TACTNET_ARCH_VL, TACTNET_ARCH_VBMI, TACTNET_ARCH_VNNI,                \
                      TACTNET_ARCH_AVXVNNI, TACTNET_ARCH_DOTPROD, TACTNET_ARCH_DSP, TACTNET_ARCH_L1,         \
                      TACTNET_ARCH_L2)
