#include "decoded.hpp"

#include <tactnet/sensors/weiss.hpp>

#include <doctest/doctest.h>

#include <ctime>
#include <string>
#include <support/allocations.hpp>
#include <vector>

using tactnet::decode_status;
using tactnet::dsacon32m;
using tactnet::weiss_wts;
using bytes = std::vector<std::uint8_t>;

namespace {

/// The checksum bit by bit, apart from the library's table: a byte goes in at the low end of a register that
/// is shifted by a whole byte, with the table's entry of a byte as what eight steps of the plain CRC make of
/// it.
std::uint16_t checksum(const bytes& data, std::size_t from) {
    std::uint16_t crc = 0xFFFF;
    for (std::size_t i = from; i < data.size(); ++i) {
        auto entry = static_cast<std::uint16_t>(((crc ^ data[i]) & 0xFF) << 8);
        for (int bit = 0; bit < 8; ++bit)
            entry = static_cast<std::uint16_t>((entry & 0x8000) != 0 ? (entry << 1) ^ 0x1021 : entry << 1);
        crc = static_cast<std::uint16_t>(entry ^ (crc >> 8));
    }
    return crc;
}

bytes packet(std::uint8_t identifier, const bytes& payload, std::size_t from) {
    bytes all{0xAA,
              0xAA,
              0xAA,
              identifier,
              static_cast<std::uint8_t>(payload.size() & 0xFF),
              static_cast<std::uint8_t>(payload.size() >> 8)};
    for (const std::uint8_t byte : payload)
        all.push_back(byte);
    const std::uint16_t crc = checksum(all, from);
    all.push_back(static_cast<std::uint8_t>(crc & 0xFF));
    all.push_back(static_cast<std::uint8_t>(crc >> 8));
    return all;
}

bytes operator+(bytes a, const bytes& b) {
    a.insert(a.end(), b.begin(), b.end());
    return a;
}

std::span<const std::byte> span_of(const bytes& data) {
    return std::as_bytes(std::span(data));
}

constexpr tactnet::weiss_array array{.rows = 2, .columns = 3};
const bytes plain{0x10, 0x27, 0, 0, 0, 1, 0, 2, 0, 3, 1, 4, 0, 0xAA, 0xAA, 0xFF, 0x0F};
const std::vector<float> plain_cells{1, 2, 259, 4, 43690, 4095};
const bytes runs{1, 0, 0, 0, 1, 0xFF, 0x2F, 0x05, 0x40};
const std::vector<float> runs_cells{4095, 4095, 5, 5, 5, 5};

} // namespace

static_assert(tactnet::frame_decoder<weiss_wts> && tactnet::frame_decoder<dsacon32m>);

TEST_CASE("weiss_decoder: the table begins as the protocol's does") {
    // One byte 0 after FFFF: table[FF] ^ 00FF = 1EF0 ^ 00FF.
    CHECK(tactnet::weiss_checksum(span_of({0x00})) == 0x1E0F);
}

TEST_CASE("weiss_decoder: frames of a WTS: plain cells, whole packet under the checksum") {
    const auto found =
        sensors_test::decode(weiss_wts(array), span_of(packet(0, plain, 0) + packet(0, runs, 0)));
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    REQUIRE(found.frames.size() == 2);
    CHECK(found.frames[0].cells == plain_cells);
    CHECK(found.frames[0].seconds == 10.0);
    CHECK(found.frames[1].cells == runs_cells);
    CHECK(found.frames[1].number == 2);
    CHECK(found.description.format == "Weiss WTS");
}

TEST_CASE("weiss_decoder: the largest") {
    constexpr std::size_t cells = (0xFFFF - 5) / 2;
    bytes payload(5 + 2 * cells, 0);
    payload.back() = 1;
    const auto found =
        sensors_test::decode(weiss_wts({.rows = 5, .columns = cells / 5}), span_of(packet(0, payload, 0)));
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    REQUIRE(found.frames.size() == 1);
    CHECK(found.frames[0].cells.back() == 256);
}

TEST_CASE("weiss_decoder: frames of a DSACON32m: runs, preamble not under the checksum") {
    const auto found = sensors_test::decode(dsacon32m(array), span_of(packet(0, runs, 3)));
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    REQUIRE(found.frames.size() == 1);
    CHECK(found.frames[0].cells == runs_cells);
    CHECK(found.frames[0].seconds == 0.001);
    CHECK(sensors_test::decode(weiss_wts(array), span_of(packet(0, runs, 3))).frames.empty());
    CHECK(sensors_test::decode(dsacon32m(array), span_of(packet(0, runs, 0))).frames.empty());
}

TEST_CASE("weiss_decoder: a stream may be joined anywhere; answers to commands are passed over") {
    const bytes stream = bytes{1, 0xAA, 0xAA, 7} + packet(0x20, {0, 0, 1}, 0) + bytes{0xAA} +
                         packet(0, plain, 0) + bytes{0xAA, 0xAA, 0xAA, 0, 0xFF, 0xFF} + packet(0, runs, 0);
    weiss_wts decoder(array);
    std::vector<std::vector<float>> frames;
    decoder.push(span_of(stream),
                 [&](const tactnet::frame_view& f) { frames.emplace_back(f.cells.begin(), f.cells.end()); });
    CHECK(decoder.finish(tactnet::ignore_frames{}) == decode_status::finished);
    CHECK(frames == std::vector{plain_cells, runs_cells});
    CHECK(decoder.skipped_bytes() == 4 + 1 + 6);
    CHECK(decoder.damaged_packets() == 1); // the header of a packet larger than any, not the longer preamble
    CHECK(sensors_test::same_however_split(weiss_wts(array), span_of(stream)));
    const bytes whole = packet(0, plain, 0) + packet(0, runs, 0);
    for (std::size_t from = 0; from < whole.size(); ++from) {
        const auto rest = sensors_test::decode(weiss_wts(array), span_of(whole).subspan(from));
        CHECK(rest.frames.size() == (from == 0 ? 2U : from <= packet(0, plain, 0).size() ? 1U : 0U));
    }
}

TEST_CASE("weiss_decoder: a damaged frame is reported, and no other is lost") {
    const bytes good = packet(0, plain, 0);
    for (std::size_t at = 6; at < good.size(); ++at) {
        bytes bad = good;
        bad[at] ^= 0x10;
        weiss_wts decoder(array);
        CHECK(decoder.push(span_of(good + bad + good), tactnet::ignore_frames{}) == decode_status::damaged);
        CHECK(decoder.frames() == 2);
        CHECK(decoder.damaged_packets() >= 1);
        CHECK(decoder.error().place() == "byte 25, frame 2");
        CHECK(decoder.error().expected.find("a checksum of") == 0);
    }
    // Any flipped bit, of the header too; as many packets follow as the largest size may reach into.
    for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
        bytes stream = good + good;
        stream[good.size() + bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
        for (int following = 0; following < 12; ++following)
            stream = stream + good;
        const auto found = sensors_test::decode(weiss_wts(array), span_of(stream));
        weiss_wts decoder(array);
        CHECK(decoder.push(span_of(stream), tactnet::ignore_frames{}) == decode_status::damaged);
        CHECK(decoder.damaged_packets() >= 1);
        CHECK(found.frames.size() == 13);
        for (const sensors_test::kept_frame& frame : found.frames)
            CHECK(frame.cells == plain_cells);
    }
    // A size that reaches into the packets after it.
    bytes longer = good;
    longer[4] += 20;
    weiss_wts reached(array);
    CHECK(reached.push(span_of(longer + good), tactnet::ignore_frames{}) == decode_status::damaged);
    CHECK(reached.frames() == 1);
    CHECK(reached.push(span_of(good), tactnet::ignore_frames{}) == decode_status::reading);
    CHECK(reached.frames() == 2);
    const auto refused = [](const bytes& payload) {
        const auto found = sensors_test::decode(weiss_wts(array), span_of(packet(0, payload, 0)));
        CHECK(found.frames.empty());
        return found.status == decode_status::finished ? std::string("nothing") : found.error;
    };
    weiss_wts decoder(array);
    const auto error = [&](const bytes& payload) {
        CHECK(decoder.push(span_of(packet(0, payload, 0)), tactnet::ignore_frames{}) ==
              decode_status::damaged);
        return decoder.error().expected + "; " + decoder.error().found;
    };
    CHECK(error({1, 2, 3}) == "a frame with a time stamp; 3 bytes");
    CHECK(error({0, 0, 0, 0, 0, 1, 0}) == "6 cells; 1");
    CHECK(error({0, 0, 0, 0, 0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0, 7, 0}) ==
          "runs of 1 to 15 cells, 6 in all; 1 after 6");
    CHECK(error({0, 0, 0, 0, 1, 0, 0x70}) == "runs of 1 to 15 cells, 6 in all; 7 after 0");
    CHECK(error({0, 0, 0, 0, 1, 5, 0x00}) == "runs of 1 to 15 cells, 6 in all; 0 after 0");
    CHECK(error({0, 0, 0, 0, 1, 5, 0x60, 1}) == "6 cells; 6 and half of one");
    CHECK(decoder.frames() == 0);
    CHECK(refused({}) == "nothing"); // reported by the push, before the end
    // Cut short.
    const auto cut = sensors_test::decode(weiss_wts(array), span_of(good).first(good.size() - 1));
    CHECK(cut.error == "byte 24, frame 1: expected a whole packet, found 24 bytes of one");
}

TEST_CASE("weiss_decoder: memory does not grow with the stream; sizes are checked") {
    weiss_wts decoder(array);
    const bytes stream = bytes(300, 0xA0) + packet(0, plain, 0), beginnings(100'000, 0xAA);
    const std::size_t before = support::bytes_allocated();
    decoder.push(span_of(beginnings), tactnet::ignore_frames{});
    for (int i = 0; i < 100; ++i)
        decoder.push(span_of(stream), tactnet::ignore_frames{});
    CHECK(support::bytes_allocated() == before);
    CHECK(decoder.frames() == 100);
    CHECK_THROWS_AS(weiss_wts({.rows = 0, .columns = 3}), std::invalid_argument);
    CHECK_THROWS_AS(weiss_wts({.rows = SIZE_MAX, .columns = 2}), std::invalid_argument);
}

TEST_CASE("weiss_decoder: any bytes take linear time, even where each could begin a packet") {
    // 50 s when the checksum of each was computed by itself.
    const tactnet::weiss_array large{.rows = 1, .columns = 21'843};
    const bytes frame = packet(0, {1, 0, 0, 0, 0}, 0); // of no cells: examined and reported
    for (const bytes& stream : {bytes(200'000, 0xAA) + bytes(50'000, 0) + frame, [&] {
                                    bytes beginnings; // of packets of 43 520 bytes
                                    for (int i = 0; i < 30'000; ++i)
                                        beginnings =
                                            std::move(beginnings) + bytes{0xAA, 0xAA, 0xAA, 0, 0, 0xAA};
                                    return beginnings + bytes(50'000, 0) + frame;
                                }()}) {
        weiss_wts decoder(large);
        const std::clock_t start = std::clock();
        decoder.push(span_of(stream), tactnet::ignore_frames{});
        CHECK(std::clock() - start < 15 * CLOCKS_PER_SEC);
        CHECK(decoder.skipped_bytes() == stream.size() - frame.size());
        CHECK(decoder.finish(tactnet::ignore_frames{}) == decode_status::finished);
    }
}
