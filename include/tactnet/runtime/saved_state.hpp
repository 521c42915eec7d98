#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/detail/xxh64.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>

// What a sensor or a robot has learnt, as bytes that outlive the program: a header, little-endian numbers and
// a checksum. Nothing here uses the heap or throws.

namespace tactnet { inline namespace TACTNET_ARCH {

/// What `restore` makes of bytes. Unless they are ok it changes nothing.
enum class restore_status : std::uint8_t {
    ok,
    other_size,  ///< not as many bytes as `save` writes: of another array, or cut
    other_state, ///< not what `save` of this class and these sizes writes
    damaged      ///< the checksum is wrong, or numbers that no state has
};

/// The status as a sentence.
[[nodiscard]] constexpr std::string_view describe(restore_status status) noexcept {
    switch (status) {
    case restore_status::ok:
        return "the state was restored";
    case restore_status::other_size:
        return "expected as many bytes as a state of these sizes has, found another number";
    case restore_status::other_state:
        return "expected a state of the same kind and sizes, found another one";
    case restore_status::damaged:
        break;
    }
    return "expected the bytes that were saved, found damage";
}

namespace detail {

/// Identifies a saved state: its kind, the version of its layout and its sizes.
struct state_header {
    std::array<char, 4> kind;
    std::uint32_t version = 1;
    std::array<std::uint32_t, 2> sizes{};

    friend bool operator==(const state_header&, const state_header&) = default;
};
inline constexpr std::size_t state_header_bytes = 16, state_checksum_bytes = 8;

/// Calls visit(number) for each number of a header, in the order of its bytes.
template <class Header, class Visit>
void visit_header(Header& header, const Visit& visit) noexcept {
    for (auto& letter : header.kind)
        visit(letter);
    visit(header.version);
    for (auto& size : header.sizes)
        visit(size);
}

template <class Number>
using bits_of_number = std::conditional_t<
    sizeof(Number) == 1, std::uint8_t,
    std::conditional_t<sizeof(Number) == 2, std::uint16_t,
                       std::conditional_t<sizeof(Number) == 4, std::uint32_t, std::uint64_t>>>;

/// Writes numbers one after the other, little-endian, into memory of the caller: a large state has no room on
/// the stack.
class state_writer {
public:
    state_writer(std::span<std::byte> to, const state_header& header) noexcept : bytes_(to) {
        visit_header(header, [&](auto number) { this->put(number); });
    }
    template <class Number>
    void put(Number number) noexcept {
        const auto bits = bits_as<bits_of_number<Number>>(number);
        for (std::size_t i = 0; i < sizeof(Number); ++i)
            bytes_[at_++] = static_cast<std::byte>(static_cast<std::uint64_t>(bits) >> 8 * i & 0xFF);
    }
    /// The last bytes are the checksum of the others.
    void finish() noexcept {
        at_ = bytes_.size() - state_checksum_bytes;
        put(xxh64().update(bytes_.first(at_)).digest());
    }

private:
    std::span<std::byte> bytes_;
    std::size_t at_ = 0;
};

/// Reads them back.
class state_reader {
public:
    /// Checks size, header and checksum; after ok there are as many numbers as were written.
    [[nodiscard]] restore_status open(std::span<const std::byte> bytes, std::size_t expected_bytes,
                                      const state_header& expected) noexcept {
        if (bytes.size() != expected_bytes)
            return restore_status::other_size;
        bytes_ = bytes;
        state_header found{};
        visit_header(found, [&](auto& number) { this->read(number); });
        if (found != expected)
            return restore_status::other_state;
        std::uint64_t checksum = 0;
        at_ = bytes.size() - state_checksum_bytes;
        const std::uint64_t right = xxh64().update(bytes.first(at_)).digest();
        read(checksum);
        at_ = state_header_bytes;
        return checksum == right ? restore_status::ok : restore_status::damaged;
    }
    template <class Number>
    void read(Number& number) noexcept {
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < sizeof(Number); ++i)
            bits |= std::to_integer<std::uint64_t>(bytes_[at_++]) << 8 * i;
        number = bits_as<Number>(static_cast<bits_of_number<Number>>(bits));
    }

private:
    std::span<const std::byte> bytes_;
    std::size_t at_ = 0;
};

/// Takes the numbers of a state from bytes, in place of what is there, unless a magnitude is beyond its bound
/// or NaN: visit_all(visit) calls visit(number, most) for each, in the order of their bytes. The state may be
/// too large for a copy on the stack, so that bytes are read twice.
template <class VisitAll>
[[nodiscard]] restore_status restore_numbers(std::span<const std::byte> from, std::size_t bytes,
                                             const state_header& header, const VisitAll& visit_all) noexcept {
    state_reader reader;
    if (const restore_status opened = reader.open(from, bytes, header); opened != restore_status::ok)
        return opened;
    state_reader ahead = reader;
    bool possible = true;
    visit_all([&](auto number, double most) {
        ahead.read(number);
        possible &= std::abs(static_cast<double>(number)) <= most;
    });
    if (possible)
        visit_all([&](auto& number, double) { reader.read(number); });
    return possible ? restore_status::ok : restore_status::damaged;
}

} // namespace detail

}} // namespace tactnet
