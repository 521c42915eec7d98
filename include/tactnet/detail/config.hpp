#pragma once

// The instruction set names an inline namespace around the whole library, so that translation units built for
// different ones can be linked into one program: the same template, compiled twice, has two names. (Not yet
// the templates of Eigen behind dense layers, which are outside: keep those in units of one instruction set.)
//
// Configuration: define TACTNET_NO_SIMD to build without vector instructions.

#if defined(TACTNET_NO_SIMD)
#define TACTNET_ARCH scalar
#elif defined(__AVX512F__) && defined(__AVX512CD__) && defined(__AVX512DQ__) && defined(__AVX512BW__)
#define TACTNET_ARCH avx512
#elif defined(__AVX2__) && defined(__FMA__)
#define TACTNET_ARCH avx2_fma
#elif defined(__AVX2__)
#define TACTNET_ARCH avx2
#elif defined(__AVX__)
#define TACTNET_ARCH avx
#elif defined(__SSE4_1__)
#define TACTNET_ARCH sse4
#elif defined(__SSE2__)
#define TACTNET_ARCH sse2
#elif defined(__aarch64__)
#define TACTNET_ARCH neon64
#else
#define TACTNET_ARCH scalar
#endif
