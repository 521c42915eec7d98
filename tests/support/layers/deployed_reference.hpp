#pragma once

// How far an output of a deployed network may be from the exact one, derived as it passes the layers: each
// number of the reference in double precision carries the bound of the error that single precision may have
// made so far (running error analysis, as everywhere in the reference). u is the unit roundoff, γ(n) = n u /
// (1 − n u), x an input with error e; no bound is a number that happened to pass.
//
// Input      (count − mean) × scale: two roundings, γ(2) |x|.
// Folding    a weight times the factor of its batch norm is computed in double and rounded once: 1 of the
//            roundings below. Batch norm alone: factor, product, sum: γ(3).
// Taps       a sum of n products, a bias and perhaps a skip, in any order, with or without fused
//            multiply-adds: no term passes more than n + 3 roundings, the one of its weight included. So
//            Σ|w| e + γ(n + 3) (Σ|w| (|x| + e) + |b| + |skip| + e of skip) + e of skip.
// Winograd   y = Aᵀ [Σ over c channels of (G g Gᵀ) ∘ (Bᵀ d B)] A + b. A term passes 2 roundings as weight
//            (folding, G g Gᵀ in double), 2 in Bᵀ d B (one addition in each direction), c + 1 in the sum over
//            the channels, 4 in Aᵀ m A, and 2 for bias and skip: γ(c + 11) times the same expression with the
//            magnitudes of all factors, |A|ᵀ [Σ (|G| |g| |G|ᵀ) ∘ (|B|ᵀ (|d| + e) |B|)] |A|. What comes in
//            wrong goes through the exact, linear map: Σ|w| e, as with taps. Tiles of 4 × 4 outputs have
//            factors that are rounded and multiplied: 4 roundings in each direction of Bᵀ d B, 5 in each of
//            Aᵀ m A: γ(c + 23).
// Max pool   passes the largest e of its window, ReLU passes e: neither rounds.
// Average    a sum of n numbers and a quotient: γ(n) Σ (|x| + e) ÷ divisor.
// Responses  see the code.
// Softmax    see the code.
// Double precision makes errors too: u is taken 2^-20 larger, thousands of times what they can add.
// Underflow  a rounding below the smallest normal number loses 2^-150 at most, whatever the number (sums lose
//            nothing there): as many times as there are products, each by what it meets on its way out. With
//            flush-to-zero, which is the program's own choice, it would be 2^-126.
//
// What bounds the worst case grows with every layer, as if all errors conspired: after a dozen layers it
// would let pass nearly anything. So each number also carries the deviation that errors have when roundings
// are independent and of mean zero (Higham and Mary, "A new approach to probabilistic rounding error
// analysis", 2019): n roundings make √n u in place of n u, and errors of the terms of a sum are added as
// squares, √(Σ w² σ²). It is no bound, but results stay below it, and mistakes far above. Tests hold results
// to both.

#include <memory>
#include <span>
#include <support/layers/reference.hpp>
#include <vector>

namespace support {

inline constexpr double deployed_roundoff = unit_roundoff<float> * (1 + 0x1p-20);

/// A network of the reference, and by which tiles its convolutions are computed, in the order of their
/// parameters.
struct described_network {
    std::shared_ptr<const reference_layer> layers;
    std::vector<tile_size> tiles{};
    bool folded = true;
};
/// The same layers where nothing is folded and no convolution is computed by tiles: the bound of batches.
[[nodiscard]] described_network as_trained(described_network network);

/// Learnable parameters and running statistics in the order of the layers.
struct network_parameters {
    std::vector<double> values, running;
    double epsilon = 1e-5;

    operator reference_call() const { return {.values = values, .running = running, .epsilon = epsilon}; }
};

/// A number with one more rounding.
[[nodiscard]] bounded rounded_once(bounded exact, double roundoff = deployed_roundoff);

/// Maps [channel][row][column] as everywhere in the reference.
[[nodiscard]] sample bounded_input(std::span<const float> counts, std::span<const float> mean, float scale);
[[nodiscard]] sample bounded_outputs(const described_network& network, const network_parameters& parameters,
                                     const sample& in);

/// One operation. The convolution of a frame with weights [filter][channel of its group][row][column], by
/// taps or by tiles; `added` may be null.
[[nodiscard]] sample bounded_convolution(const reference_window& window, std::size_t filters,
                                         std::span<const double> weights, const sample& biases,
                                         const sample& in, const sample* added, tile_size tiled,
                                         std::size_t groups = 1);
[[nodiscard]] sample bounded_max_pool(const reference_window& window, const sample& in);
[[nodiscard]] sample bounded_relu(sample in);

/// The outputs of a map, with pixels `stride` elements apart, that are further from the exact ones than
/// the bound or than twice their deviation, and what is not zero after the last channel.
[[nodiscard]] std::size_t outputs_outside(const sample& expected, std::size_t area, const float* found,
                                          std::size_t stride);

} // namespace support
