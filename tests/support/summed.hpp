#pragma once

#include <tactnet/detail/xxh64.hpp>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace support {

/// A saved state with the checksum that its other bytes have.
template <class Bytes>
[[nodiscard]] Bytes summed(Bytes state) {
    const std::uint64_t sum =
        tactnet::xxh64().update(std::span<const std::byte>(state).first(state.size() - 8)).digest();
    std::memcpy(state.data() + state.size() - 8, &sum, sizeof(sum));
    return state;
}

} // namespace support
