#pragma once

#include <tactnet/detail/config.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

/// XXH64 of bytes that come in pieces of any sizes, by Yann Collet (described in doc/xxhash_spec.md of
/// https://github.com/Cyan4973/xxHash). It is faster than any disk, and misses damage with a probability of
/// about one in 2^64. It does not protect from someone who changes bytes on purpose and computes the checksum
/// again.
class xxh64 {
public:
    explicit constexpr xxh64(std::uint64_t seed = 0) noexcept
        : lanes_{seed + prime1 + prime2, seed + prime2, seed, seed - prime1}, seed_(seed) {}

    // On pointers: iterators of spans take programs that load a network longer to compile.
    [[gnu::noinline]] xxh64& update(std::span<const std::byte> bytes) noexcept {
        const std::byte* from = bytes.data();
        std::size_t left = bytes.size(), waiting = static_cast<std::size_t>(length_ % stripe);
        length_ += left;
        if (waiting + left >= stripe) {
            if (waiting > 0) {
                const std::size_t missing = stripe - waiting;
                std::copy_n(from, missing, rest_.data() + waiting);
                consume(rest_.data(), stripe);
                from += missing, left -= missing, waiting = 0;
            }
            const std::size_t whole = left / stripe * stripe;
            consume(from, whole);
            from += whole, left -= whole;
        }
        std::copy_n(from, left, rest_.data() + waiting);
        return *this;
    }
    xxh64& update(std::string_view text) noexcept {
        return update({reinterpret_cast<const std::byte*>(text.data()), text.size()});
    }

    /// Returns the checksum of all bytes so far.
    [[nodiscard]] std::uint64_t digest() const noexcept {
        std::uint64_t hash = seed_ + prime5;
        if (length_ >= stripe) {
            hash = std::rotl(lanes_[0], 1) + std::rotl(lanes_[1], 7) + std::rotl(lanes_[2], 12) +
                   std::rotl(lanes_[3], 18);
            for (const std::uint64_t lane : lanes_)
                hash = (hash ^ round(0, lane)) * prime1 + prime4;
        }
        hash += length_;
        const std::byte* next = rest_.data();
        auto left = static_cast<std::size_t>(length_ % stripe);
        for (; left >= 8; left -= 8, next += 8)
            hash = std::rotl(hash ^ round(0, number<std::uint64_t>(next)), 27) * prime1 + prime4;
        if (left >= 4) {
            hash = std::rotl(hash ^ number<std::uint32_t>(next) * prime1, 23) * prime2 + prime3;
            left -= 4, next += 4;
        }
        for (; left > 0; --left, ++next)
            hash = std::rotl(hash ^ std::to_integer<std::uint64_t>(*next) * prime5, 11) * prime1;
        hash = (hash ^ hash >> 33) * prime2;
        hash = (hash ^ hash >> 29) * prime3;
        return hash ^ hash >> 32;
    }

private:
    static constexpr std::uint64_t prime1 = 0x9E3779B185EBCA87, prime2 = 0xC2B2AE3D27D4EB4F,
                                   prime3 = 0x165667B19E3779F9, prime4 = 0x85EBCA77C2B2AE63,
                                   prime5 = 0x27D4EB2F165667C5;
    static constexpr std::size_t stripe = 32;

    static constexpr std::uint64_t round(std::uint64_t lane, std::uint64_t input) noexcept {
        return std::rotl(lane + input * prime2, 31) * prime1;
    }
    /// Reads a little-endian number and widens it.
    template <class Number>
    static std::uint64_t number(const std::byte* bytes) noexcept {
        if constexpr (std::endian::native == std::endian::little) {
            Number value;
            std::memcpy(&value, bytes, sizeof(value));
            return value;
        } else {
            std::uint64_t value = 0;
            for (std::size_t i = sizeof(Number); i > 0; --i)
                value = value << 8 | std::to_integer<std::uint64_t>(bytes[i - 1]);
            return value;
        }
    }
    void consume(const std::byte* at, std::size_t size) noexcept {
        auto [a, b, c, d] = lanes_; // in registers
        for (const std::byte* const end = at + size; at != end; at += stripe) {
            a = round(a, number<std::uint64_t>(at));
            b = round(b, number<std::uint64_t>(at + 8));
            c = round(c, number<std::uint64_t>(at + 16));
            d = round(d, number<std::uint64_t>(at + 24));
        }
        lanes_ = {a, b, c, d};
    }

    std::array<std::uint64_t, 4> lanes_;
    std::array<std::byte, stripe> rest_{};
    std::uint64_t seed_;
    std::uint64_t length_ = 0;
};

}} // namespace tactnet
