#pragma once

#include <tactnet/detail/config.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string_view>
#include <utility>

// Counter-based random numbers: Philox 4×32-10 (Salmon, Moraes, Dror, Shaw, "Parallel random numbers: as easy
// as 1, 2, 3", SC 2011). The numbers of (seed, stream, item) are the same wherever and in whatever order they
// are drawn.

namespace tactnet { inline namespace TACTNET_ARCH {

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

/// A purpose of random numbers, identified by its number. Each purpose has its own numbers, so that one more
/// draw for one does not change another. Numbers below 2³¹ belong to the library, which declares its purposes
/// next to the code that draws; name your own:
///
///     inline constexpr auto slip = tactnet::random_purpose::named("my_gripper/slip");
template <class Kind>
class numbered_purpose {
public:
    /// A purpose of the library or of a test. A number from 2³¹ on does not compile.
    explicit consteval numbered_purpose(std::uint32_t number) : number_(number) {
        if (number >= first_named)
            throw "numbered_purpose: numbers from 2^31 are those of purposes with a name";
    }
    /// A purpose of your own. Its number is a hash of the name (FNV-1a) from 2³¹ on, so it is never one of
    /// the library's. Two names share a number with a probability of 2⁻³¹; `static_assert(a != b)` excludes
    /// it.
    [[nodiscard]] static consteval numbered_purpose named(std::string_view name) {
        std::uint32_t hash = 0x811C9DC5;
        for (const char letter : name)
            hash = (hash ^ static_cast<std::uint8_t>(letter)) * 0x01000193;
        numbered_purpose purpose(0);
        purpose.number_ = hash | first_named;
        return purpose;
    }
    [[nodiscard]] constexpr std::uint32_t number() const { return number_; }

    friend constexpr bool operator==(numbered_purpose, numbered_purpose) = default;

private:
    static constexpr std::uint32_t first_named = 0x80000000;

    std::uint32_t number_;
};

/// What a stream of random numbers is drawn for.
using random_purpose = numbered_purpose<class random_stream>;

/// Purposes that several rooms draw for; the others are declared in their rooms.
namespace random_purposes {
inline constexpr random_purpose split{0}; ///< assigning samples to data sets and folds
inline constexpr random_purpose order{1}; ///< the order of samples
} // namespace random_purposes

/// The numbers of one item: for example (seed, random_purposes::augmentation, epoch, sample).
class random_stream {
public:
    constexpr random_stream(std::uint64_t seed, random_purpose purpose, std::uint32_t major = 0,
                            std::uint32_t minor = 0)
        : key_{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)},
          counter_{0, purpose.number(), major, minor} {}

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

    /// The arguments of philox: block n of this stream, of four words, is that of the counter {n, …} and the
    /// key.
    [[nodiscard]] constexpr const std::array<std::uint32_t, 4>& next_counter() const { return counter_; }
    [[nodiscard]] constexpr const std::array<std::uint32_t, 2>& key() const { return key_; }

private:
    std::array<std::uint32_t, 2> key_;
    std::array<std::uint32_t, 4> counter_;
    std::array<std::uint32_t, 4> values_{};
    std::size_t next_ = 4;
};

}} // namespace tactnet
