#include "../decoded.hpp"
#include "written_recording.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/recording.hpp>
#include <tactnet/sensors/tekscan/binary.hpp>
#include <tactnet/sensors/tekscan/binary_checks.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <support/allocations.hpp>
#include <support/files/data_folder.hpp>
#include <utility>
#include <vector>

using sensors_test::bytes_of;
using sensors_test::decoded;
using sensors_test::little;
using sensors_test::usual_records;
using sensors_test::written_header;
using sensors_test::written_records;
using tactnet::decode_status;
using tactnet::tekscan_binary;
using namespace std::string_literals;

namespace {

using strings = std::vector<std::string>;

/// Frames with these runs and records, whole and closed; they are taken in any pieces.
decoded decode(const strings& frames, const std::string& header = "",
               const std::string& behind = "\xFF\xFE") {
    std::string bytes = header.empty() ? written_header(frames.size()) : header;
    for (const std::string& frame : frames)
        bytes += frame;
    bytes += behind;
    CHECK(sensors_test::same_however_split(tekscan_binary(), bytes_of(bytes)));
    return sensors_test::decode(tekscan_binary(), bytes_of(bytes));
}

/// Cells 7 to 9, and 12.
std::string frame(const written_records& records,
                  const std::string& runs = "\x07\x00\x03\x05\x03\x09\x0C\x00\x01\x04"s) {
    return runs + "\xFF\xFF" + records.bytes();
}

/// What is warned of, without the place.
strings texts(const decoded& found) {
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    strings result;
    for (const std::string& warning : found.warnings)
        result.push_back(warning.substr(warning.find(": ") + 2));
    return result;
}

strings of_records(const std::vector<written_records>& records) {
    strings frames;
    for (const written_records& each : records)
        frames.push_back(frame(each));
    return texts(decode(frames));
}

std::string replaced(std::string text, std::string_view from, std::string_view to) {
    return text.replace(text.find(from), from.size(), to);
}

} // namespace

TEST_CASE("tekscan_binary_checks: nothing to say about what a writer writes") {
    const decoded found =
        sensors_test::decode(tekscan_binary(), bytes_of(sensors_test::written_recording(60)));
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    CHECK(found.warnings.empty());
    CHECK(found.certain_frames == 60);
}

TEST_CASE("tekscan_binary_checks: counts that a writer leaves out") {
    const auto found =
        decode({frame(usual_records(0)), frame(usual_records(1), "\x07\x00\x04\x03\x02\x00\x03"s)});
    const std::string header = written_header(2);
    const std::size_t byte = header.size() + frame(usual_records(0)).size() + 4;
    CHECK(found.warnings ==
          strings{"byte " + std::to_string(byte) +
                      ", frame 2: expected counts of at least 3 (NOISE_THRESHOLD), found 2 in cell 8",
                  "byte " + std::to_string(byte + 1) +
                      ", frame 2: expected counts of at least 3 (NOISE_THRESHOLD), found 0 in cell 9"});
    // A warning changes nothing about the frame.
    CHECK(found.frames.at(1).cells[8] == 2);
    // Without a threshold zeros are left out all the same; one that no count reaches is held to be 255.
    const std::string runs = "\x07\x00\x02\x00\x01"s;
    CHECK(texts(decode({frame(usual_records(0), runs)},
                       replaced(written_header(1), "NOISE_THRESHOLD 3", "NOISE_THRESHOLD 0"))) ==
          strings{"expected counts of at least 1, as zeros are left out, found 0 in cell 7"});
    CHECK(texts(decode({frame(usual_records(0), "\x07\x00\x02\xFF\xFE"s)},
                       replaced(written_header(1), "NOISE_THRESHOLD 3", "NOISE_THRESHOLD 1e9"))) ==
          strings{"expected counts of at least 255 (NOISE_THRESHOLD), found 254 in cell 8"});
}

TEST_CASE("tekscan_binary_checks: runs that touch") {
    CHECK(texts(decode({frame(usual_records(0), "\x07\x00\x01\x05\x08\x00\x01\x05"s)})) ==
          strings{"expected a run from cell 9 on, as runs without a gap are written as one, found cell 8"});
    CHECK(texts(decode({frame(usual_records(0), "\x00\x00\x01\x05\x02\x00\x01\x05"s)})).empty());
}

TEST_CASE("tekscan_binary_checks: frames that were lost") {
    CHECK(of_records({usual_records(0), usual_records(1), usual_records(4), usual_records(5)}) ==
          strings{"expected frame number 3, found number 5"});
    // An excerpt begins anywhere.
    CHECK(of_records({usual_records(7), usual_records(8)}).empty());
}

TEST_CASE("tekscan_binary_checks: times that cannot be") {
    const auto at = [](std::uint64_t number, std::uint64_t time) {
        return written_records{number, time, sensors_test::first_time_of_day + 10 * time};
    };
    // As far as half a frame from where SECONDS_PER_FRAME puts it.
    CHECK(of_records({at(1, 0), at(2, 5000), at(3, 20'000)}).empty());
    CHECK(of_records({at(1, 0), at(2, 4999)}) ==
          strings{"expected a time about 0.01 s after the frame before, found 0.004999 s"});
    CHECK(of_records({at(1, 0), at(2, 15'001)}).size() == 1);
    // Backwards, and far away: reported for the frame itself and for the one after it.
    CHECK(of_records({at(1, 20'000), at(2, 10'000)}) ==
          strings{"expected a time about 0.01 s after the frame before, found -0.01 s"});
    CHECK(of_records({at(1, 0), at(2, std::uint64_t{1} << 60), at(3, 20'000), at(4, 30'000)}).size() == 2);
    // Without SECONDS_PER_FRAME only backwards.
    const std::string header = replaced(written_header(2), "SECONDS_PER_FRAME", "SECONDS");
    CHECK(texts(decode({frame(at(1, 0)), frame(at(2, 9'000'000))}, header)) ==
          strings{"expected a line 'SECONDS_PER_FRAME' in the header, found none that can be read"});
    CHECK(texts(decode({frame(at(1, 5)), frame(at(2, 4))}, header)).back() ==
          "expected a time after the frame before, found -1e-06 s");
}

TEST_CASE("tekscan_binary_checks: the time of day and the time since the start say the same") {
    auto records = std::vector{usual_records(0), usual_records(1), usual_records(2)};
    records[0].time_of_day += 1;
    CHECK(of_records(records) ==
          strings{"expected a time of day (record 16) of 132285760968014362, as record 2 gives, "
                  "found 132285760968014363",
                  "expected a time of day (record 16) of 132285760968114363, as record 2 gives, "
                  "found 132285760968114362"});
    records = {usual_records(0), usual_records(1), usual_records(2)};
    records[1].microseconds ^= 1;
    CHECK(of_records(records).size() == 2);
    // A start that cannot be read is that of the first frame.
    const std::string header = replaced(written_header(1), "TIME_2 1d5", "TIME_2 xd5");
    records[0].time_of_day += 77;
    CHECK(texts(decode({frame(records[0])}, header)).empty());
    // A record of another length is unknown.
    const std::string other = "\xFF\xFF\x10\x00\x02\x00\x01\x01\xFF\xFF"s;
    CHECK(texts(decode({other, other})).empty());
}

TEST_CASE("tekscan_binary_checks: records unlike those of the frame before") {
    const std::string bare = "\xFF\xFF\xFF\xFF";
    CHECK(texts(decode({frame(usual_records(0)), bare, bare, frame(usual_records(3))})) ==
          strings(2, "expected records with the tags and lengths of the frame before, found others"));
}

TEST_CASE("tekscan_binary_checks: the header") {
    const std::string bare = "\xFF\xFF\xFF\xFF";
    CHECK(
        decode({bare}, "ROWS 3\nCOLS 4\n\xBB\xBA").warnings ==
        strings{
            "byte 0, line 1: expected a line 'NOISE_THRESHOLD' in the header, found none that can be read",
            "byte 0, line 1: expected a line 'SECONDS_PER_FRAME' in the header, found none that can be read",
            "byte 0, line 1: expected a line 'FRAMES' in the header, found none that can be read"});
    const auto control = decode({bare}, replaced(written_header(1), "HW_TYPE 7", "HW_TY\x01\x7F 7\t\r"));
    CHECK(control.warnings == strings{"byte 21, line 2: expected text, found a control character, 1",
                                      "byte 22, line 2: expected text, found a control character, 127"});
    // What is odd in a header puts no frame in doubt.
    CHECK(control.certain_frames == 1);
    CHECK(decode({bare}, replaced(written_header(1), "GraphBox", "Gr\xFCn")).warnings.empty());
}

TEST_CASE("tekscan_binary_checks: a frame is certain once what follows it fits") {
    const auto usual = [](std::uint64_t index) { return frame(usual_records(index)); };
    const std::string header = written_header(3);
    CHECK(decode({usual(0), usual(1), usual(2)}).certain_frames == 3);
    // Two whole frames, and damage in the third: the second has nothing after it.
    const auto refused = decode({usual(0), usual(1)}, header, "\x07\x00\x00"s);
    CHECK(refused.status == decode_status::damaged);
    CHECK(refused.frames.size() == 2);
    CHECK(refused.certain_frames == 1);
    CHECK(decode({}, header, "\x07\x00\x00"s).certain_frames == 0);
    CHECK(decode({usual(0), usual(1)}, header).certain_frames == 1); // one is missing before FF FE
    // Bytes that went missing between the middles of two frames leave one that is both. Its number shows it.
    const auto merged = decode({usual(0), usual(1), usual(4), usual(5)}, written_header(6));
    CHECK(merged.status == decode_status::damaged);
    CHECK(merged.frames.size() == 4);
    CHECK(merged.certain_frames == 1);
    // A warning, and no frame after it is certain.
    CHECK(decode({usual(0), usual(1), usual(4), usual(5)}).certain_frames == 1);
}

TEST_CASE("tekscan_binary_checks: warnings use no heap and are bounded") {
    std::string bytes = written_header(1000);
    tekscan_binary decoder;
    decoder.push(bytes_of(bytes), tactnet::ignore_frames{});
    strings frames;
    for (std::uint64_t i = 0; i < 1000; ++i) // zeros, runs that touch, and times that go backwards
        frames.push_back(frame({2 * i + 1, 2000 - i, i}, "\x07\x00\x02\x00\x05\x09\x00\x01\x05"s));
    const std::size_t before = support::bytes_allocated();
    for (const std::string& each : frames)
        REQUIRE(decoder.push(bytes_of(each), tactnet::ignore_frames{}) == decode_status::reading);
    CHECK(support::bytes_allocated() == before);
    CHECK(decoder.warnings().count() == 1000 * 2 + 999 * 2 + 1000);
    CHECK(decoder.warnings().kept().size() == tactnet::decoding_warnings::capacity);
}

TEST_CASE("tekscan_binary_checks: the real recording is what they are measured on" *
          doctest::test_suite("data")) {
    const auto path = support::find_data("tekscan/MySampleRecording.fsx");
    if (!path)
        return;
    const auto found = tactnet::read_recording(*path);
    CHECK(found.warnings.count() == 0);
    CHECK(found.certain_frames == 500);
}

namespace {

using tactnet::tekscan_binary_records;

constexpr std::array<std::byte, 8> bytes{std::byte{1}, std::byte{2}, std::byte{3}, std::byte{4},
                                         std::byte{5}, std::byte{6}, std::byte{7}, std::byte{8}};

TEST_CASE("tekscan_binary_records: numbers and times, in any pieces") {
    for (std::size_t piece = 1; piece <= bytes.size(); ++piece) {
        tekscan_binary_records records;
        const auto take = [&](std::uint16_t tag, std::size_t length) {
            records.announce(tag, static_cast<std::uint16_t>(length));
            for (std::size_t at = 0; at < length;) {
                CHECK(!records.whole());
                const auto rest = std::span(bytes).subspan(at);
                // More than the record has: it leaves what is not its own.
                const std::size_t taken = records.consume(rest.first(std::min(piece, rest.size())));
                CHECK(taken == std::min(piece, length - at));
                at += taken;
            }
            CHECK(records.whole());
        };
        take(tekscan_binary_records::frame_number, 4);
        take(tekscan_binary_records::microseconds, 8);
        take(tekscan_binary_records::time_of_day, 8);
        CHECK(records.number == 0x04030201);
        CHECK(records.time == 0x0807060504030201);
        CHECK(records.day_time == 0x0807060504030201);
    }
}

TEST_CASE("tekscan_binary_records: unknown ones and a time of day of another length are passed over") {
    tekscan_binary_records records;
    for (const auto& [tag, length] : {std::pair<std::uint16_t, std::uint16_t>{7, 5}, {16, 4}, {9, 0}}) {
        records.announce(tag, length);
        CHECK(records.consume(bytes) == length);
        CHECK(records.whole());
    }
    CHECK(!records.number);
    CHECK(!records.time);
    CHECK(!records.day_time);
}

TEST_CASE("tekscan_binary_records: a layout is tags and lengths in their order") {
    const auto layout = [](std::array<std::pair<std::uint16_t, std::uint16_t>, 2> announced) {
        tekscan_binary_records records;
        for (const auto& [tag, length] : announced)
            records.announce(tag, length);
        return records.layout();
    };
    const auto usual = layout({{{1, 4}, {2, 8}}});
    CHECK(usual == layout({{{1, 4}, {2, 8}}}));
    CHECK(usual != layout({{{2, 8}, {1, 4}}}));
    CHECK(usual != layout({{{1, 4}, {2, 9}}}));
}

} // namespace
