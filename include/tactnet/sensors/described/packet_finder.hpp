#pragma once

#include <tactnet/sensors/described/checksum.hpp>
#include <tactnet/sensors/described/description.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

// Finds the packets of a stream in which bytes may be lost, inserted, doubled or changed, and whose cells may
// look like a marker.
//
// A *hit* is a place where a packet fits: the marker and, if there is one, the checksum are right. Hits a
// whole number of packets apart support each other, others contradict each other: the bytes of the cells may
// look like a marker in every frame. So a packet is certain when the hits that follow it, in a window of one
// to eight packets, support it and no other place that is repeated as often:
// - the place at its end hits, and if nothing else does, enough of the places expected after that: none for a
//   marker of two bytes or more, and more if the marker is short or often seen in cells,
// - otherwise, at least two more than twice the hits of every other place do.
// With a checksum, a packet is certain if no other place hits. While two places fit, no packet is certain.

namespace tactnet { inline namespace TACTNET_ARCH {

/// What is known about a place in a stream.
enum class packet_state : std::uint8_t { unknown, certain, rejected, ambiguous };

/// Finds packets in the bytes of a stream that are in memory.
class packet_finder {
public:
    explicit packet_finder(const sensor_description& d)
        : marker_(d.marker),
          size_(d.packet_bytes()),
          checksum_(d.checksum),
          check_(d.checksum),
          covered_(size_ - d.end_bytes - d.checksum.bytes()) {
        hits_.reserve(most_hits + 1);
    }

    static constexpr std::size_t largest_window = 8; ///< packets

    [[nodiscard]] std::size_t packet_bytes() const noexcept { return size_; }
    /// Bytes from the start of a packet that decide whether it hits.
    [[nodiscard]] std::size_t hit_bytes() const noexcept {
        return checksum_.bytes() > 0 ? size_ : marker_.size();
    }
    [[nodiscard]] bool has_checksum() const noexcept { return checksum_.bytes() > 0; }

    /// Whether a packet fits at the start of `bytes`, which are at least `hit_bytes`.
    [[nodiscard]] bool fits(std::span<const std::byte> bytes) const noexcept {
        if (!marker_.empty() && std::memcmp(bytes.data(), marker_.data(), marker_.size()) != 0)
            return false;
        const std::size_t from = checksum_.with_marker ? 0 : marker_.size();
        return !has_checksum() ||
               check_.follows(bytes.subspan(from, covered_ - from), bytes.subspan(covered_));
    }
    /// The first place at or after `from` where a packet fits; if there is none, the first place for which
    /// bytes are missing.
    [[nodiscard]] std::size_t find(std::span<const std::byte> bytes, std::size_t from) const noexcept {
        for (; bytes.size() >= from + hit_bytes(); ++from) {
            const std::size_t places = bytes.size() - hit_bytes() + 1 - from;
            if (!marker_.empty()) {
                const void* const found =
                    std::memchr(bytes.data() + from, static_cast<int>(marker_[0]), places);
                if (found == nullptr)
                    return from + places;
                from = static_cast<std::size_t>(static_cast<const std::byte*>(found) - bytes.data());
            }
            if (fits(bytes.subspan(from)))
                break;
        }
        return from;
    }

    /// Reads the hits of `bytes`, of which those before have been read; the first byte is number `begin` of
    /// the stream. Stops at `until`, or at the first hit after it. Then `any` has none of the packet before.
    void read(std::span<const std::byte> bytes, std::uint64_t begin, std::uint64_t until) {
        while (read_ < until) {
            const std::size_t at = find(bytes, static_cast<std::size_t>(read_ - begin));
            if (bytes.size() < at + hit_bytes()) {
                read_ = begin + at;
                return;
            }
            read_ = begin + at + 1;
            if (read_ <= expected_) { // in a packet with a checksum
                alone_ = false, ++others_;
                continue;
            }
            hits_.push_back(begin + at);
            if (is_crowded())
                return;
        }
    }

    /// Whether there are more places than can be told apart.
    [[nodiscard]] bool is_crowded() const noexcept { return hits_.size() - first_ > most_hits; }
    /// Whether all hits that `judge` needs have been read.
    [[nodiscard]] bool can_judge() const noexcept { return read_ >= due() || is_crowded(); }
    /// Whether there is a place that may be a packet.
    [[nodiscard]] bool any() const noexcept { return first_ < hits_.size(); }
    /// The first place that may be a packet.
    [[nodiscard]] std::uint64_t first() const noexcept { return hits_[first_]; }
    /// Places of the stream before this one have been read.
    [[nodiscard]] std::uint64_t read_to() const noexcept { return read_; }
    /// How far hits must have been read to judge the first place with the present window.
    [[nodiscard]] std::uint64_t due() const noexcept {
        return first() + window_ * size_ + std::max<std::size_t>(marker_.size(), 1);
    }

    /// Judges the first place by all hits up to `due`; at the end of a stream, by those that are there.
    [[nodiscard]] packet_state judge(bool at_end = false) {
        if (is_crowded())
            return packet_state::ambiguous;
        const std::uint64_t at = first(), due = this->due();
        std::size_t own = 0;
        bool followed = false; // by a packet at its end
        offsets_.clear();
        for (std::size_t i = first_ + 1; i < hits_.size() && hits_[i] < due; ++i)
            if (const auto offset = static_cast<std::uint32_t>((hits_[i] - at) % size_); offset == 0) {
                ++own;
                followed = followed || hits_[i] - at == size_;
            } else {
                offsets_.push_back(offset);
            }
        std::size_t others = most_equal();
        if (has_checksum()) {
            if (at < doubtful_until_)
                others = std::max<std::size_t>(others, 1);
            if (others == 0)
                return packet_state::certain;
        } else if (!followed) { // a part of the packet may be lost
            return others == 0 && at_end ? packet_state::certain : packet_state::rejected;
        } else if (at < doubtful_until_ &&
                   (marker_.size() == 1 || at - dropped_ < marker_.size() || at < unsettled_until_)) {
            // Either the place before has lost bytes, or it has gained some, and this is a part of it.
            return packet_state::rejected;
        }
        if (others == 0 ? own >= needed() || at_end : own >= 2 * others + 2)
            return packet_state::certain;
        if (others >= 2 * own + 2)
            return packet_state::rejected;
        if (window_ == largest_window || at_end)
            return 2 * own < window_ ? packet_state::rejected : packet_state::ambiguous;
        ++window_;
        return packet_state::unknown;
    }
    /// Whether nothing but the place of the packet before supports the first place, which has a checksum.
    [[nodiscard]] bool continues() const noexcept { return has_checksum() && alone_ && first() == expected_; }

    /// Drops the first place, which is none of a packet.
    void drop(packet_state why) noexcept {
        dropped_ = first();
        doubtful_until_ = dropped_ + size_;
        if (why == packet_state::ambiguous)
            unsettled_until_ = dropped_ + unsettled_packets * size_;
        ++first_, window_ = 1;
        alone_ = false;
        tidy();
    }
    /// Drops the first place, which is a packet, and all in it. Hits in it have been read.
    void accept() noexcept {
        expected_ = first() + size_;
        window_ = 1;
        alone_ = true;
        for (++first_; any() && first() < expected_; ++first_) {
            alone_ = false;
            ++others_;
            unsettled_until_ = expected_ + unsettled_packets * size_;
        }
        places_ += size_;
        constexpr std::uint64_t remembered = std::uint64_t{1} << 16U;
        if (places_ > remembered)
            places_ /= 2, others_ /= 2;
        tidy();
    }

private:
    /// More hits than these in a window are too many to tell apart.
    static constexpr std::size_t most_hits = 512;
    /// How long cells that looked like a marker are expected to do so again.
    static constexpr std::size_t unsettled_packets = 256;

    /// The most hits of any other place.
    [[nodiscard]] std::size_t most_equal() {
        std::sort(offsets_.begin(), offsets_.end());
        std::size_t most = 0, equal = 0;
        for (std::size_t i = 0; i < offsets_.size(); ++i) {
            equal = i > 0 && offsets_[i] == offsets_[i - 1] ? equal + 1 : 1;
            most = std::max(most, equal);
        }
        return most;
    }
    /// How many hits make it unlikely, by less than one in 50 000, that all are chance.
    [[nodiscard]] std::size_t needed() const noexcept {
        double chance = marker_.size() == 1 ? 1. / 256 : 1. / 65536;
        if (others_ > 0)
            chance = std::max(chance, static_cast<double>(others_) / static_cast<double>(places_));
        std::size_t count = 1;
        if (first() <
            unsettled_until_) // inserted bytes may have put cells that look so where a marker belongs
            chance = std::max(chance, 1. / 256);
        for (double all = chance; all > 2e-5 && count < largest_window; all *= chance)
            ++count;
        return count;
    }
    void tidy() {
        if (first_ < most_hits / 2 && any())
            return;
        hits_.erase(hits_.begin(), hits_.begin() + static_cast<std::ptrdiff_t>(first_));
        first_ = 0;
    }

    std::vector<std::byte> marker_;
    std::size_t size_;
    packet_checksum checksum_;
    checksum_of check_;
    std::size_t covered_;             ///< bytes before the checksum
    std::vector<std::uint64_t> hits_; ///< from `first_` on, the places that have not been judged
    std::size_t first_ = 0, window_ = 1;
    std::uint64_t read_ = 0, expected_ = 0;
    std::uint64_t dropped_ = 0, doubtful_until_ = 0; ///< the place that was dropped last, and its end
    std::uint64_t unsettled_until_ = 0;              ///< cells have looked like a marker in packets before
    std::vector<std::uint32_t> offsets_;
    bool alone_ = false;                      ///< the packet before was certain, with no other hit in it
    std::uint64_t others_ = 0, places_ = 512; ///< hits that were none of packets, among the latest places
};

}} // namespace tactnet
