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
// Helium's vectors of floats and integers need no xsimd.
#if !defined(TACTNET_NO_SIMD) && defined(__ARM_FEATURE_MVE) && !defined(__ARM_BIG_ENDIAN)
#if __ARM_FEATURE_MVE & 2
#define TACTNET_HELIUM
#endif
#endif
#if !defined(TACTNET_NO_SIMD) && !defined(__SSE2__) && !defined(__aarch64__) && !defined(__wasm_simd128__)
#define TACTNET_NO_SIMD
#endif

// Clang before version 15 does not define __ARM_FEATURE_DOTPROD for Armv8.4 and later. Of these it tells
// Armv8.5 and 9 from others.
#if defined(__ARM_FEATURE_DOTPROD) ||                                                                        \
    (defined(__clang__) && defined(__aarch64__) &&                                                           \
     (defined(__ARM_FEATURE_FRINT) || defined(__ARM_FEATURE_MATMUL_INT8) || __ARM_ARCH >= 9))
#define TACTNET_DOTPROD 1
#elif defined(__clang__) && __clang_major__ < 15 && defined(__ARM_FEATURE_JCVT) && !defined(TACTNET_NO_SIMD)
#pragma message("tactnet: this compiler does not say whether there are dot products: add +dotprod to -march")
#endif

// The table of names: each has a short form for the namespace and a long one for people.
#define TACTNET_ARCH_SHORT(name, text) name
#define TACTNET_ARCH_LONG(name, text) text
#if defined(TACTNET_NO_SIMD) && !defined(TACTNET_HELIUM)
#define TACTNET_ARCH_KIND(form) form(for_scalar_, "scalar")
#else
#define TACTNET_ARCH_KIND(form) form(for_, "simd")
#endif
// A level includes those below it. Vectors of SVE have the length for which they are compiled, if that is
// fixed.
#if defined(__AVX512F__)
#define TACTNET_ARCH_LEVEL(form) form(avx512, "_avx512f")
#elif defined(__AVX2__)
#define TACTNET_ARCH_LEVEL(form) form(avx2, "_avx2")
#elif defined(__AVX__)
#define TACTNET_ARCH_LEVEL(form) form(avx, "_avx")
#elif defined(__SSE4_2__)
#define TACTNET_ARCH_LEVEL(form) form(sse42, "_sse42")
#elif defined(__SSE4_1__)
#define TACTNET_ARCH_LEVEL(form) form(sse41, "_sse41")
#elif defined(__SSSE3__)
#define TACTNET_ARCH_LEVEL(form) form(ssse3, "_ssse3")
#elif defined(__SSE3__)
#define TACTNET_ARCH_LEVEL(form) form(sse3, "_sse3")
#elif defined(__SSE2__)
#define TACTNET_ARCH_LEVEL(form) form(sse2, "_sse2")
#elif defined(__ARM_FEATURE_SVE) && __ARM_FEATURE_SVE_BITS > 0
#define TACTNET_ARCH_LEVEL(form)                                                                             \
    form(TACTNET_ARCH_JOIN(sve, __ARM_FEATURE_SVE_BITS), "_sve" TACTNET_ARCH_TEXT(__ARM_FEATURE_SVE_BITS))
#elif defined(__ARM_FEATURE_SVE)
#define TACTNET_ARCH_LEVEL(form) form(sve, "_sve")
#elif defined(__aarch64__)
#define TACTNET_ARCH_LEVEL(form) form(neon, "_neon64")
#elif defined(__wasm_simd128__)
#define TACTNET_ARCH_LEVEL(form) form(wasm128, "_wasm128")
#elif defined(__ARM_FEATURE_MVE) // 1: integers, 3: also floats
#define TACTNET_ARCH_LEVEL(form)                                                                             \
    form(TACTNET_ARCH_JOIN(helium, __ARM_FEATURE_MVE), "_helium" TACTNET_ARCH_TEXT(__ARM_FEATURE_MVE))
#else
#define TACTNET_ARCH_LEVEL(form) form(base, "")
#endif
// Extensions: the macro of the compiler, which is 1 if there is one. A letter each; capitals where AMD and
// Intel differ.
// clang-format off
#define TACTNET_ARCH_EXTENSIONS(add, level)       \
    add(add(add(add(add(add(add(add(add(add(add(add(add(add(level, \
        __FMA__, f, "_fma"),                      \
        __FMA4__, F, "_fma4"),                    \
        __BMI2__, b, "_bmi2"),                    \
        __LZCNT__, l, "_lzcnt"),                  \
        __AVX512CD__, c, "_cd"),                  \
        __AVX512DQ__, d, "_dq"),                  \
        __AVX512BW__, w, "_bw"),                  \
        __AVX512VL__, v, "_vl"),                  \
        __AVX512VBMI__, m, "_vbmi"),              \
        __AVX512VNNI__, n, "_vnni"),              \
        __AVXVNNI__, N, "_avxvnni"),              \
        TACTNET_DOTPROD, p, "_dotprod"),          \
        __ARM_FEATURE_MATMUL_INT8, i, "_i8mm"),   \
        __ARM_FEATURE_SIMD32, s, "_dsp")
// clang-format on

// Arguments are expanded before they are joined or become a text.
#define TACTNET_ARCH_JOIN(first, second) TACTNET_ARCH_JOINED(first, second)
#define TACTNET_ARCH_JOINED(first, second) first##second
#define TACTNET_ARCH_TEXT(...) TACTNET_ARCH_TEXT_OF(__VA_ARGS__)
#define TACTNET_ARCH_TEXT_OF(...) #__VA_ARGS__
// `yes` if a macro of the compiler is 1, and nothing if it is not defined.
#define TACTNET_ARCH_IF(value, yes)                                                                          \
    TACTNET_ARCH_SECOND(TACTNET_ARCH_JOIN(TACTNET_ARCH_COMMA_IF_, value) yes, , )
#define TACTNET_ARCH_SECOND(...) TACTNET_ARCH_SECOND_OF(__VA_ARGS__)
#define TACTNET_ARCH_SECOND_OF(first, second, ...) second
#define TACTNET_ARCH_COMMA_IF_1 ,
#define TACTNET_ARCH_ADD_SHORT(before, macro, letter, text)                                                  \
    TACTNET_ARCH_JOIN(before, TACTNET_ARCH_IF(macro, letter))
#define TACTNET_ARCH_ADD_LONG(before, macro, letter, text) before TACTNET_ARCH_IF(macro, text)

// Cache sizes, where they are configured (kernels/caches.hpp), decide how much memory a kernel takes. They
// must be plain numbers, since they become part of the name, and be defined before the first header.
#if defined(TACTNET_L1_CACHE_KIB)
#define TACTNET_ARCH_L1 TACTNET_ARCH_JOIN(_l1_, TACTNET_L1_CACHE_KIB)
#else
#define TACTNET_ARCH_L1
#define TACTNET_L1_CACHE_BY_DEFAULT
#endif
#if defined(TACTNET_L2_CACHE_KIB)
#define TACTNET_ARCH_L2 TACTNET_ARCH_JOIN(_l2_, TACTNET_L2_CACHE_KIB)
#else
#define TACTNET_ARCH_L2
#define TACTNET_L2_CACHE_BY_DEFAULT
#endif
// How quickly weights come from beyond these caches: decides between methods of convolution.
#if defined(TACTNET_FAR_BYTES_PER_CYCLE)
#define TACTNET_ARCH_FAR TACTNET_ARCH_JOIN(_far_, TACTNET_FAR_BYTES_PER_CYCLE)
#else
#define TACTNET_ARCH_FAR
#define TACTNET_FAR_BY_DEFAULT
#endif

/// For example for_avx2fbl, or for_scalar_sse2.
#define TACTNET_ARCH                                                                                         \
    TACTNET_ARCH_JOIN(                                                                                       \
        TACTNET_ARCH_EXTENSIONS(TACTNET_ARCH_ADD_SHORT,                                                      \
                                TACTNET_ARCH_JOIN(TACTNET_ARCH_KIND(TACTNET_ARCH_SHORT),                     \
                                                  TACTNET_ARCH_LEVEL(TACTNET_ARCH_SHORT))),                  \
        TACTNET_ARCH_JOIN(TACTNET_ARCH_JOIN(TACTNET_ARCH_L1, TACTNET_ARCH_L2), TACTNET_ARCH_FAR))
