#pragma once

#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <array>
#include <cstddef>

// What the core can do at most: independent chains of multiply-adds in registers, as many as hide the
// latency.

namespace benchmark {

inline constexpr std::size_t chains = 12, chain_length = 10'000;
inline constexpr std::size_t multiply_adds_of_chains = chains * chain_length * tactnet::kernels::lanes<float>;

/// The seed must be unknown to the compiler; 1 keeps the numbers finite.
[[gnu::flatten, gnu::noinline]] inline float run_chains(float seed) {
    std::array<tactnet::kernels::vector<float>, chains> x;
    tactnet::kernels::unroll<chains>(
        [&](auto i) { x[i] = tactnet::kernels::vector<float>(seed + static_cast<float>(i)); });
    const tactnet::kernels::vector<float> a(0.999f * seed), b(0.001f * seed);
    for (std::size_t s = 0; s < chain_length; ++s)
        tactnet::kernels::unroll<chains>([&](auto i) { x[i] = tactnet::kernels::multiply_add(x[i], a, b); });
    alignas(64) std::array<float, tactnet::kernels::lanes<float>> flat;
    float sum = 0;
    tactnet::kernels::unroll<chains>([&](auto i) {
        tactnet::kernels::store(flat.data(), x[i]);
        sum += flat[0];
    });
    return sum;
}

} // namespace benchmark
