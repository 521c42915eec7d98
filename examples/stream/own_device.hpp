#pragma once

// A device of your own: this one sends 'T', 'N', a number that counts up to 255 and starts again, the cells,
// and a byte that makes the exclusive or of all bytes after 'N' zero. Copy it, and change what your device
// does otherwise.

#include <tactnet/sensors/decoder.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>

class own_device : public tactnet::decoder_base {
public:
    static constexpr std::size_t rows = 28, columns = 50;

    own_device() : decoder_base({.format = "own device", .rows = rows, .columns = columns}) {}

    template <class Sink>
    tactnet::decode_status push(std::span<const std::byte> bytes, Sink&& sink) {
        set_status(tactnet::decode_status::reading);
        for (const std::byte byte : bytes) {
            ++byte_;
            packet_[size_++] = byte;
            // Out of step, a byte that cannot be where it is begins anew: one may join a stream anywhere. But
            // after a packet comes the next, or one is lost.
            if (size_ <= start.size() && byte != start[size_ - 1]) {
                if (in_step_)
                    fail({byte_ - 1, 0, frames() + 1, "'TN' in front of a packet", "other bytes"});
                in_step_ = false;
                last_.reset();
                size_ = byte == start[0] ? 1 : 0;
                packet_[0] = byte;
            }
            if (size_ == packet_.size())
                read_packet(sink);
        }
        return status();
    }

    template <class Sink>
    tactnet::decode_status finish(Sink&&) {
        set_status(tactnet::decode_status::finished);
        if (size_ > 0)
            fail({byte_, 0, frames() + 1, "a whole packet", std::to_string(size_) + " bytes of one"});
        return status();
    }

private:
    static constexpr std::array<std::byte, 2> start{std::byte{'T'}, std::byte{'N'}};

    template <class Sink>
    void read_packet(Sink& sink) {
        std::byte sum{0};
        for (std::size_t i = start.size(); i < size_; ++i)
            sum ^= packet_[i];
        size_ = 0;
        in_step_ = true;
        if (sum != std::byte{0}) {
            last_.reset(); // of which packet it was nothing is known
            fail({byte_ - packet_.size(),
                  0,
                  frames() + 1,
                  "a sum of zero",
                  std::to_string(static_cast<int>(sum)),
                  {}});
            return;
        }
        // The cells of a packet after others that were lost, doubled or exchanged are good all the same.
        const auto number = std::to_integer<unsigned>(packet_[start.size()]);
        if (const unsigned next = last_ ? (*last_ + 1) % 256 : number; number != next)
            fail({byte_ - packet_.size(), 0, frames() + 1, "packet number " + std::to_string(next),
                  std::to_string(number)});
        last_ = number;
        for (std::size_t i = 0; i < cells().size(); ++i)
            cells()[i] = static_cast<float>(packet_[start.size() + 1 + i]);
        emit(sink, frames() + 1, {});
    }

    std::array<std::byte, start.size() + 1 + rows * columns + 1> packet_{};
    std::size_t size_ = 0, byte_ = 0;
    bool in_step_ = false;
    std::optional<unsigned> last_; ///< the number of the packet before
};
static_assert(tactnet::frame_decoder<own_device>);
