// Any bytes as a stream of a WTS sensor and of a DSACON32m controller.

#include "decoder_fuzz.hpp"
#include "fuzz_target.hpp"

#include <tactnet/sensors/weiss.hpp>

namespace {

constexpr tactnet::weiss_array array{.rows = 2, .columns = 3};

std::vector<std::uint8_t> packet(std::uint8_t identifier, const std::vector<std::uint8_t>& payload,
                                 std::size_t from) {
    std::vector<std::uint8_t> bytes{0xAA, 0xAA, 0xAA, identifier, static_cast<std::uint8_t>(payload.size()),
                                    0};
    for (const std::uint8_t byte : payload)
        bytes.push_back(byte);
    const std::uint16_t checksum = tactnet::weiss_checksum(std::as_bytes(std::span(bytes)).subspan(from));
    bytes.push_back(static_cast<std::uint8_t>(checksum & 0xFFU));
    bytes.push_back(static_cast<std::uint8_t>(checksum >> 8U));
    return bytes;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto bytes = fuzz::bytes_of(data, size);
    fuzz_forms(size, 3, [&](std::size_t form) {
        if (form == 0)
            return fuzz::check(tactnet::weiss_wts(array), bytes);
        if (form == 1)
            return fuzz::check(tactnet::dsacon32m(array), bytes);
        // Few inputs have a right checksum: once more with the input as the payload of packets that have.
        std::vector<std::uint8_t> stream;
        for (std::size_t from = 0; from < size; from += 17) {
            const std::size_t count = std::min<std::size_t>(17, size - from);
            const auto one = packet(0, std::vector<std::uint8_t>(data + from, data + from + count), 0);
            stream.insert(stream.end(), one.begin(), one.end());
        }
        fuzz::check(tactnet::weiss_wts(array), fuzz::bytes_of(stream.data(), stream.size()));
    });
    return 0;
}

std::vector<std::vector<std::uint8_t>> fuzz_seeds() {
    const std::vector<std::uint8_t> plain{1, 0, 0, 0, 0, 1, 0, 2, 0, 3, 1, 4, 0, 5, 0, 255, 15};
    const std::vector<std::uint8_t> runs{2, 0, 0, 0, 1, 0, 0x20, 5, 0x40};
    std::vector<std::uint8_t> both = packet(0, plain, 0);
    const auto second = packet(0, runs, 0), answer = packet(0x20, {0, 0}, 0);
    both.insert(both.end(), {0xAA, 0x01});
    both.insert(both.end(), second.begin(), second.end());
    both.insert(both.end(), answer.begin(), answer.end());
    return {both, packet(0, plain, 3), packet(0, runs, 3), plain, runs};
}
