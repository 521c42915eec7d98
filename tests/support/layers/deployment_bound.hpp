#pragma once

// How far an output of a deployed network may be from the exact one, derived as it passes the layers: each
// number of the reference in double precision carries the bound of the error that single precision may have
// made so far (running error analysis; Higham, "Accuracy and stability of numerical algorithms", 2nd edition,
// chapter 3). u is the unit roundoff, γ(n) = n u / (1 − n u), x an input with error e; no bound is a number
// that happened to pass.
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
// What bounds the worst case grows with every layer, as if all errors conspired: behind a dozen layers it
// would let pass nearly anything. So each number also carries the deviation that errors have when roundings
// are independent and of mean zero (Higham and Mary, "A new approach to probabilistic rounding error
// analysis", 2019): n roundings make √n u in place of n u, and errors of the terms of a sum are added as
// squares, √(Σ w² σ²). It is no bound, but results stay below it, and mistakes far above. Tests hold results
// to both.

#include <functional>
#include <span>
#include <support/layers/reference.hpp>
#include <support/layers/tile_magnitudes.hpp>
#include <vector>

namespace support {

/// A number of the reference, the bound of the error of a result in single precision, and the deviation of
/// it.
struct rounded {
    double value = 0, error = 0, deviation = 0;
};
/// [channel][row][column]
using rounded_map = std::vector<rounded>;

/// A layer of a network, as the bound needs it. Lists keep their nesting: a batch norm is folded into a
/// convolution of its own list only.
struct described_layer {
    enum class kind {
        convolution,
        norm,
        relu,
        pool,
        average,
        responses,
        dense,
        softmax,
        dropout,
        list,
        residual,
        concatenation,
        own
    };
    kind what;
    reference_window window{}; ///< of convolutions, pools and (as large as the image) dense layers
    std::size_t filters = 0;   ///< outputs of dense layers
    std::size_t groups = 1;    ///< of a convolution
    bool bias = true;          ///< of a convolution
    bool alone = false; ///< not folded with what stands beside it, as in batches: a convolution, a norm
    tile_size tiled{};  ///< of a convolution, how it is computed
    std::vector<described_layer> inner{}, skip{};
    /// Of a concatenation: lists.
    std::vector<described_layer> branches{};
    /// Of averages: of each output pixel the pixels that it is made of, and what their sum is divided by.
    extents3 average_output{};
    std::vector<std::vector<std::size_t>> average_pixels{};
    std::vector<double> average_divisors{};
    /// Of local responses: channels, the window, α ÷ size, β, k.
    std::size_t response_channels = 0, response_size = 0;
    double response_share = 0, response_beta = 0, response_k = 1;
    /// What a layer that this file does not know makes of a map, from `own_values` learnable parameters and
    /// `own_statistics` running statistics, one behind the other.
    std::function<rounded_map(rounded_map, std::span<const float>)> own{};
    std::size_t own_values = 0, own_statistics = 0;
    extents3 own_output{0, 0, 0}; ///< where the map is of another shape than its input
};

/// As a bound, one rounding of a result of that size.
[[nodiscard]] rounded rounded_once(rounded exact);

/// The convolution of one frame with weights [filter][channel][row][column], by taps or by tiles; `added` may
/// be null. Values [channel][row][column] as everywhere in the reference.
[[nodiscard]] rounded_map bounded_convolution(const reference_window& window, std::size_t filters,
                                              std::span<const double> weights,
                                              std::span<const rounded> biases, const rounded_map& in,
                                              const rounded_map* added, tile_size tiled);
[[nodiscard]] rounded_map bounded_max_pool(const reference_window& window, const rounded_map& in);
[[nodiscard]] rounded_map bounded_relu(rounded_map in);
[[nodiscard]] rounded_map bounded_input(std::span<const float> counts, std::span<const float> mean,
                                        float scale);

/// Learnable parameters and running statistics in the order of the layers.
struct described_parameters {
    std::span<const float> values, statistics;
    double epsilon = 1e-5;
};
[[nodiscard]] rounded_map bounded_outputs(const std::vector<described_layer>& layers,
                                          const described_parameters& parameters, const rounded_map& in);

} // namespace support
