#pragma once

#include <tactnet/version.hpp>

#if __cplusplus < 202002L
#error "tactnet needs C++20: GCC 12, Clang 14 or newer with -std=c++20"
// A file that is not there ends the compilation, so that the sentence above is the last one.
#include <tactnet_needs_cxx20>
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
// standard library, and of Eigen behind eigen.hpp and simulation/effects/circuit/resistive_network.hpp, which
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

// A level includes those below it.
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
#elif defined(__ARM_FEATURE_SVE)
#define TACTNET_ARCH_LEVEL sve
#elif defined(__aarch64__)
#define TACTNET_ARCH_LEVEL neon
#elif defined(__wasm_simd128__)
#define TACTNET_ARCH_LEVEL wasm128
#else
#define TACTNET_ARCH_LEVEL base
#endif

// One letter per extension; capitals where AMD and Intel differ, or for ARM.
#if defined(__FMA__)
#define TACTNET_ARCH_FMA f
#else
#define TACTNET_ARCH_FMA
#endif
#if defined(__FMA4__)
#define TACTNET_ARCH_FMA4 F
#else
#define TACTNET_ARCH_FMA4
#endif
#if defined(__BMI2__)
#define TACTNET_ARCH_BMI2 b
#else
#define TACTNET_ARCH_BMI2
#endif
#if defined(__LZCNT__)
#define TACTNET_ARCH_LZCNT l
#else
#define TACTNET_ARCH_LZCNT
#endif
#if defined(__AVX512CD__)
#define TACTNET_ARCH_CD c
#else
#define TACTNET_ARCH_CD
#endif
#if defined(__AVX512DQ__)
#define TACTNET_ARCH_DQ d
#else
#define TACTNET_ARCH_DQ
#endif
#if defined(__AVX512BW__)
#define TACTNET_ARCH_BW w
#else
#define TACTNET_ARCH_BW
#endif
#if defined(__AVX512VL__)
#define TACTNET_ARCH_VL v
#else
#define TACTNET_ARCH_VL
#endif
#if defined(__AVX512VBMI__)
#define TACTNET_ARCH_VBMI m
#else
#define TACTNET_ARCH_VBMI
#endif
#if defined(__AVX512VNNI__)
#define TACTNET_ARCH_VNNI n
#else
#define TACTNET_ARCH_VNNI
#endif
#if defined(__AVXVNNI__)
#define TACTNET_ARCH_AVXVNNI N
#else
#define TACTNET_ARCH_AVXVNNI
#endif
#if defined(__ARM_FEATURE_DOTPROD)
#define TACTNET_ARCH_DOTPROD p
#else
#define TACTNET_ARCH_DOTPROD
#endif
#if defined(__arm__) && defined(__ARM_FEATURE_DSP)
#define TACTNET_ARCH_DSP s
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
