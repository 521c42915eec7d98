#pragma once

// A device of your own whose packets are numbered: 'T', 'N', a number that counts up to 255 and starts again,
// the cells, and a byte that makes the exclusive or of all bytes after 'N' zero. Without the numbers, a
// description would do: tactnet::matrix_stream. Copy it, and change what your device does otherwise.
//
// The form that matters: a packet that is wrong loses its first byte only. The next packet may begin in it.

#include <tactnet/sensors/decoder.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

class own_device : public tactnet::decoder_base {
public:
    static constexpr std::size_t rows = 28, columns = 50;

    own_device() : decoder_base({.format = "own device", .rows = rows, .columns = columns}) {}

    template <class Sink>
    tactnet::decode_status push(std::span<const std::byte> bytes, Sink&& sink) {
        set_status(tactnet::decode_status::reading);
        bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
        std::size_t at = 0;
        while (at < bytes_.size()) {
            const auto rest = std::span<const std::byte>(bytes_).subspan(at);
            const std::size_t known = std::min(rest.size(), start.size());
            if (!std::equal(start.begin(), start.begin() + static_cast<std::ptrdiff_t>(known),
                            rest.begin())) {
                if (in_step_) // else one joins the stream here, and may do so anywhere
                    report_once(at, "'TN' in front of a packet", "other bytes");
                lose_step();
                ++at;
            } else if (rest.size() < packet_size) {
                break;
            } else if (const std::byte sum = sum_of(rest); sum != std::byte{0}) {
                report_once(at, "a sum of zero", std::to_string(static_cast<int>(sum)));
                lose_step();
                ++at;
            } else {
                read_packet(rest, at, sink);
                at += packet_size;
            }
        }
        bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(at));
        byte_ += at;
        return status();
    }

    template <class Sink>
    tactnet::decode_status finish(Sink&&) {
        set_status(tactnet::decode_status::finished);
        if (!bytes_.empty())
            fail({byte_, 0, frames() + 1, "a whole packet", std::to_string(bytes_.size()) + " bytes of one"});
        return status();
    }

private:
    static constexpr std::array<std::byte, 2> start{std::byte{'T'}, std::byte{'N'}};
    static constexpr std::size_t packet_size = start.size() + 1 + rows * columns + 1;

    static std::byte sum_of(std::span<const std::byte> packet) {
        std::byte sum{0};
        for (const std::byte byte : packet.first(packet_size).subspan(start.size()))
            sum ^= byte;
        return sum;
    }
    /// Once until the next packet: what was lost may look like the start of several.
    void report_once(std::size_t at, std::string expected, std::string found) {
        if (!reported_)
            fail({byte_ + at, 0, frames() + 1, std::move(expected), std::move(found)});
        reported_ = true;
    }
    void lose_step() {
        in_step_ = false;
        last_.reset();
    }

    template <class Sink>
    void read_packet(std::span<const std::byte> packet, std::size_t at, Sink& sink) {
        in_step_ = true;
        reported_ = false;
        // The cells of a packet after others that were lost, doubled or exchanged are good all the same.
        const auto number = std::to_integer<unsigned>(packet[start.size()]);
        if (const unsigned next = last_ ? (*last_ + 1) % 256 : number; number != next)
            fail({byte_ + at, 0, frames() + 1, "packet number " + std::to_string(next),
                  std::to_string(number)});
        last_ = number;
        for (std::size_t i = 0; i < cells().size(); ++i)
            cells()[i] = static_cast<float>(packet[start.size() + 1 + i]);
        emit(sink, frames() + 1, {});
    }

    std::vector<std::byte> bytes_; ///< from byte number `byte_` on
    std::size_t byte_ = 0;
    bool in_step_ = false, reported_ = false;
    std::optional<unsigned> last_; ///< the number of the packet before
};
static_assert(tactnet::frame_decoder<own_device>);
