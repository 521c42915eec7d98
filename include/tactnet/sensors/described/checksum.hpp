#pragma once

#include <tactnet/sensors/described/description.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

// Checksums of packets, as a description names them.

namespace tactnet { inline namespace TACTNET_ARCH {

/// Computes a checksum.
class checksum_of {
public:
    explicit checksum_of(const packet_checksum& description) : description_(description) {
        const bool short_crc = description.kind == checksum_kind::crc8;
        if (!short_crc && description.kind != checksum_kind::crc16)
            return;
        // Held at the top of 16 bits, or at the bottom if reflected.
        const unsigned usual = short_crc ? 0x07U : 0x1021U;
        const unsigned polynomial = description.polynomial != 0 ? description.polynomial : usual;
        const unsigned top = short_crc ? 0x80U : 0x8000U, all = 2 * top - 1;
        unsigned mirrored = 0;
        for (unsigned bit = 1, other = top; bit <= top; bit *= 2, other /= 2)
            mirrored |= (polynomial & bit) != 0 ? other : 0;
        for (unsigned byte = 0; byte < table_.size(); ++byte) {
            unsigned value = description.reflected ? byte : short_crc ? byte : byte << 8U;
            for (int bit = 0; bit < 8; ++bit)
                value = description.reflected ? value >> 1U ^ ((value & 1U) != 0 ? mirrored : 0)
                                              : (value << 1U ^ ((value & top) != 0 ? polynomial : 0)) & all;
            table_[byte] = static_cast<std::uint16_t>(value);
        }
    }

    [[nodiscard]] std::uint16_t operator()(std::span<const std::byte> bytes) const noexcept {
        unsigned value = description_.initial;
        switch (description_.kind) {
        case checksum_kind::none:
            return 0;
        case checksum_kind::xor8:
            for (const std::byte byte : bytes)
                value ^= static_cast<unsigned>(byte);
            break;
        case checksum_kind::sum8:
        case checksum_kind::sum16:
            for (const std::byte byte : bytes)
                value += static_cast<unsigned>(byte);
            break;
        case checksum_kind::crc8:
            for (const std::byte byte : bytes)
                value = table_[(value ^ static_cast<unsigned>(byte)) & 0xFFU];
            break;
        case checksum_kind::crc16:
            for (const std::byte byte : bytes)
                value = description_.reflected
                            ? table_[(value ^ static_cast<unsigned>(byte)) & 0xFFU] ^ value >> 8U
                            : (table_[(value >> 8U ^ static_cast<unsigned>(byte)) & 0xFFU] ^ value << 8U) &
                                  0xFFFFU;
            break;
        }
        if (description_.negated)
            value = 0U - value;
        value ^= description_.final_xor;
        return static_cast<std::uint16_t>(description_.bytes() == 1 ? value & 0xFFU : value);
    }

    /// Whether the checksum that follows `bytes` is theirs.
    [[nodiscard]] bool follows(std::span<const std::byte> bytes,
                               std::span<const std::byte> given) const noexcept {
        if (description_.bytes() == 0)
            return true;
        const std::uint16_t sum = (*this)(bytes);
        return description_.bytes() == 1                  ? sum == static_cast<std::uint16_t>(given[0])
               : description_.order == byte_order::little ? sum == little_endian<std::uint16_t>(given)
                                                          : sum == big_endian<std::uint16_t>(given);
    }

private:
    packet_checksum description_;
    std::array<std::uint16_t, 256> table_{};
};

}} // namespace tactnet
