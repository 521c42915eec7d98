#pragma once

#include <tactnet/detail/config.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

// Counter-based random numbers: Philox 4×32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy
// as 1, 2, 3", SC 2011). The numbers of (seed, stream, item) are the same wherever and in whatever order they
// are drawn.

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Ten rounds of Philox over one counter.
[[nodiscard]] constexpr std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                                            std::array<std::uint32_t, 2> key) {
    for (int round = 0; round < 10; ++round) {
        const std::uint64_t a = std::uint64_t{0xD2511F53} * counter[0],
                            b = std::uint64_t{0xCD9E8D57} * counter[2];
        counter = {static_cast<std::uint32_t>(b >> 32) ^ counter[1] ^ key[0], static_cast<std::uint32_t>(b),
                   static_cast<std::uint32_t>(a >> 32) ^ counter[3] ^ key[1], static_cast<std::uint32_t>(a)};
        key[0] += 0x9E3779B9;
        key[1] += 0xBB67AE85;
    }
    return counter;
}

/// What random numbers are drawn for. Each purpose has numbers of its own, so that one more draw for one does
/// not change another.
enum class draw : std::uint32_t {
    split,
    order,
    augmentation,
    initial_weights,
    dropout,
    clusters,
    noise,
    sensor, ///< what a simulated sensor was made with
    frame,  ///< what befalls one simulated frame
    touch,  ///< what touches a simulated sensor, and how
};

/// The numbers of one item: for example (seed, draw::augmentation, epoch, sample).
class random_stream {
public:
    constexpr random_stream(std::uint64_t seed, draw purpose, std::uint32_t major = 0,
                            std::uint32_t minor = 0)
        : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
          counter_{0, static_cast<std::uint32_t>(purpose), major, minor} {}

    [[nodiscard]] constexpr std::uint32_t bits() {
        if (next_ == 4) {
            values_ = philox(counter_, key_);
            ++counter_[0];
            next_ = 0;
        }
        return values_[next_++];
    }
    /// Uniform in [0, 1), a multiple of 2⁻³².
    [[nodiscard]] constexpr double uniform() { return bits() * 0x1p-32; }
    [[nodiscard]] constexpr double uniform(double low, double high) { return low + (high - low) * uniform(); }
    /// Uniform in 0 … bound − 1 (Lemire's multiplication; bias below 2⁻³² × bound).
    [[nodiscard]] constexpr std::uint32_t below(std::uint32_t bound) {
        return static_cast<std::uint32_t>((std::uint64_t{bits()} * bound) >> 32);
    }
    /// Standard normal, by Box and Muller's transform.
    [[nodiscard]] double normal() {
        const double radius = std::sqrt(-2 * std::log((bits() + 0.5) * 0x1p-32));
        return radius * std::cos(2 * std::numbers::pi * uniform());
    }
    /// Puts the elements of a random-access range in random order (Fisher and Yates).
    template <class Range>
    constexpr void shuffle(Range& range) {
        for (std::size_t i = range.size(); i > 1; --i)
            std::swap(range[i - 1], range[below(static_cast<std::uint32_t>(i))]);
    }

    /// What this stream puts into philox: the words of block n, four each, are those of {n, …} and the key.
    [[nodiscard]] constexpr const std::array<std::uint32_t, 4>& next_counter() const { return counter_; }
    [[nodiscard]] constexpr const std::array<std::uint32_t, 2>& key() const { return key_; }

private:
    std::array<std::uint32_t, 2> key_;
    std::array<std::uint32_t, 4> counter_;
    std::array<std::uint32_t, 4> values_{};
    std::size_t next_ = 4;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
