#pragma once

// Files with one bit other than it was written.

#include <tactnet/runtime/random.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace support {

inline void flip(std::vector<std::byte>& bytes, std::size_t bit) {
    bytes[bit / 8] ^= static_cast<std::byte>(1U << bit % 8);
}

/// The bits whose change goes unnoticed, of all or of so many drawn from a seed; `noticed(bytes)` says.
template <class Noticed>
std::vector<std::size_t> unnoticed_flips(std::vector<std::byte> bytes, const Noticed& noticed,
                                         std::size_t drawn = 0) {
    std::vector<std::size_t> unnoticed;
    const std::size_t bits = bytes.size() * 8;
    tactnet::random_stream random(14, tactnet::random_purpose::named("tests/bit_flips"));
    for (std::size_t i = 0; i < (drawn == 0 ? bits : drawn); ++i) {
        const std::size_t bit =
            drawn == 0 ? i : static_cast<std::size_t>(random.below(static_cast<std::uint32_t>(bits)));
        flip(bytes, bit);
        if (!noticed(bytes))
            unnoticed.push_back(bit);
        flip(bytes, bit);
    }
    return unnoticed;
}

} // namespace support
