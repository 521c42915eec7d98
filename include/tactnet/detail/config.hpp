#pragma once

#include <tactnet/version.hpp>

#if __cplusplus < 202002L
#error "tactnet needs C++20: GCC 12, Clang 14 or newer with -std=c++20"
// A file that is not there ends the compilation, so that the sentence above is the last one.
#include <tactnet_needs_cxx20>
#endif

// The instruction set names an inline namespace around the whole library, so that translation units built for
// different ones can be linked into one program: the same template, compiled twice, has two names, and the
// linker never takes one unit's for the other's.
//
// Told apart is all that changes the layout of vectors, what xsimd chooses, or which instructions a compiler
// puts in unasked: the level of SSE and AVX, FMA (both kinds), BMI2, LZCNT, each AVX-512 extension that is
// used for floats, integers or bytes, AVX-VNNI, NEON with its products of bytes and SVE, the products of
// pairs of 32-bit ARM, and TACTNET_NO_SIMD. Not told apart is xsimd's version: a program has one. What lies
// outside this namespace is the program's own care: templates of the standard library, and of Eigen behind
// eigen.hpp and simulation/effects/circuit/positive_definite.hpp, which belong into units of one instruction
// set.
//
// Configuration: define TACTNET_NO_SIMD to build without vector instructions. So is built by itself where
// there are none of which xsimd makes vectors both of float and of double: SSE2 and above, 64-bit ARM,
// WebAssembly's.
#if !defined(TACTNET_NO_SIMD) && !defined(__SSE2__) && !defined(__aarch64__) && !defined(__wasm_simd128__)
#define TACTNET_NO_SIMD
#endif

#if defined(TACTNET_NO_SIMD)
#define TACTNET_ARCH_KIND scalar
#else
#define TACTNET_ARCH_KIND simd
#endif

// A level holds those below it.
#if defined(__AVX512F__)
#define TACTNET_ARCH_LEVEL _avx512f
#elif defined(__AVX2__)
#define TACTNET_ARCH_LEVEL _avx2
#elif defined(__AVX__)
#define TACTNET_ARCH_LEVEL _avx
#elif defined(__SSE4_2__)
#define TACTNET_ARCH_LEVEL _sse42
#elif defined(__SSE4_1__)
#define TACTNET_ARCH_LEVEL _sse41
#elif defined(__SSSE3__)
#define TACTNET_ARCH_LEVEL _ssse3
#elif defined(__SSE3__)
#define TACTNET_ARCH_LEVEL _sse3
#elif defined(__SSE2__)
#define TACTNET_ARCH_LEVEL _sse2
#elif defined(__ARM_FEATURE_SVE)
#define TACTNET_ARCH_LEVEL _sve
#elif defined(__aarch64__)
#define TACTNET_ARCH_LEVEL _neon64
#else
#define TACTNET_ARCH_LEVEL
#endif

#if defined(__FMA__)
#define TACTNET_ARCH_FMA _fma
#else
#define TACTNET_ARCH_FMA
#endif
#if defined(__FMA4__)
#define TACTNET_ARCH_FMA4 _fma4
#else
#define TACTNET_ARCH_FMA4
#endif
#if defined(__BMI2__)
#define TACTNET_ARCH_BMI2 _bmi2
#else
#define TACTNET_ARCH_BMI2
#endif
#if defined(__LZCNT__)
#define TACTNET_ARCH_LZCNT _lzcnt
#else
#define TACTNET_ARCH_LZCNT
#endif
#if defined(__AVX512CD__)
#define TACTNET_ARCH_CD _cd
#else
#define TACTNET_ARCH_CD
#endif
#if defined(__AVX512DQ__)
#define TACTNET_ARCH_DQ _dq
#else
#define TACTNET_ARCH_DQ
#endif
#if defined(__AVX512BW__)
#define TACTNET_ARCH_BW _bw
#else
#define TACTNET_ARCH_BW
#endif
#if defined(__AVX512VL__)
#define TACTNET_ARCH_VL _vl
#else
#define TACTNET_ARCH_VL
#endif
#if defined(__AVX512VBMI__)
#define TACTNET_ARCH_VBMI _vbmi
#else
#define TACTNET_ARCH_VBMI
#endif
#if defined(__AVX512VNNI__)
#define TACTNET_ARCH_VNNI _vnni
#else
#define TACTNET_ARCH_VNNI
#endif
#if defined(__AVXVNNI__)
#define TACTNET_ARCH_AVXVNNI _avxvnni
#else
#define TACTNET_ARCH_AVXVNNI
#endif
#if defined(__ARM_FEATURE_DOTPROD)
#define TACTNET_ARCH_DOTPROD _dotprod
#else
#define TACTNET_ARCH_DOTPROD
#endif

#if defined(__arm__) && defined(__ARM_FEATURE_DSP)
#define TACTNET_ARCH_DSP _dsp
#else
#define TACTNET_ARCH_DSP
#endif

// Sizes of caches, where they are given (kernels/caches.hpp): they decide how much memory a kernel takes.
// Plain numbers, since they become part of a name; given before the first header, or not at all.
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
// Once more, so that the parts are what they stand for before they are joined.
#define TACTNET_ARCH_JOIN(...) TACTNET_ARCH_JOINED(__VA_ARGS__)
/// For example simd_avx2_fma, or scalar_sse2.
#define TACTNET_ARCH                                                                                         \
    TACTNET_ARCH_JOIN(TACTNET_ARCH_KIND, TACTNET_ARCH_LEVEL, TACTNET_ARCH_FMA, TACTNET_ARCH_FMA4,            \
                      TACTNET_ARCH_BMI2, TACTNET_ARCH_LZCNT, TACTNET_ARCH_CD, TACTNET_ARCH_DQ,               \
                      TACTNET_ARCH_BW, TACTNET_ARCH_VL, TACTNET_ARCH_VBMI, TACTNET_ARCH_VNNI,                \
                      TACTNET_ARCH_AVXVNNI, TACTNET_ARCH_DOTPROD, TACTNET_ARCH_DSP, TACTNET_ARCH_L1,         \
                      TACTNET_ARCH_L2)
