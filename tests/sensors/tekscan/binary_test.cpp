#include "../decoded.hpp"
#include "written_recording.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/tekscan/binary.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <random>
#include <string>
#include <string_view>
#include <support/allocations.hpp>
#include <support/files/data_folder.hpp>
#include <utility>
#include <vector>

namespace {

using namespace std::string_literals;
using sensors_test::bytes_of;
using sensors_test::decoded;
using sensors_test::kept_frame;
using tactnet::decode_status;
using tactnet::tekscan_binary;

decoded decode(std::string_view bytes) {
    return sensors_test::decode(tekscan_binary(), bytes_of(bytes));
}

const std::string header =
    "VERSION Tek API\nROWS 3\nCOLS 4\nUNITS PSI\nSECONDS_PER_FRAME 0.01\nFRAMES 3\n\xBB\xBA";
const std::string end_list = "\xFF\xFF", closing = "\xFF\xFE";
// Cells 0 and 1, and 11; number 5, 10 000 microseconds, and an unknown record.
const std::string first =
    "\x00\x00\x02\x07\x08\x0B\x00\x01\xFF"s + end_list + "\x01\x00\x04\x00\x05\x00\x00\x00"s +
    "\x02\x00\x08\x00\x10\x27\x00\x00\x00\x00\x00\x00"s + "\x63\x00\x03\x00\xFF\xFF\xFF"s + end_list;
const std::string empty = end_list + end_list;
const std::string third = "\x04\x00\x04\x01\x02\x03\x04"s + end_list + "\x10\x00\x00\x00"s + end_list;
const std::string recording = header + first + empty + third + closing;

std::string replaced(std::string text, std::string_view from, std::string_view to) {
    return text.replace(text.find(from), from.size(), to);
}

static_assert(tactnet::frame_decoder<tekscan_binary>);

TEST_CASE("tekscan_binary: runs and records") {
    const auto found = decode(recording);
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    REQUIRE(found.frames.size() == 3);
    CHECK(found.frames[0].cells == std::vector<float>{7, 8, 0, 0, 0, 0, 0, 0, 0, 0, 0, 255});
    CHECK(found.frames[1].cells == std::vector<float>(12));
    CHECK(found.frames[2].cells == std::vector<float>{0, 0, 0, 0, 1, 2, 3, 4, 0, 0, 0, 0});
    CHECK(found.frames[0].number == 5);
    CHECK(found.frames[1].number == 6);
    CHECK(found.frames[2].number == 7);
    CHECK(found.frames[0].seconds == 0.01);
    CHECK(found.frames[2].seconds == 0.02);
    CHECK(found.description.frames == 3);
    CHECK(found.description.version == "Tek API");
    // The unit is one for showing; a length without a unit is none.
    CHECK((found.description.unit == tactnet::pressure_unit::raw));
    CHECK(decode(replaced(recording, "UNITS PSI", "UNITS bananas")).frames == found.frames);
    CHECK(!decode(replaced(recording, "UNITS", "ROW_SPACING 1\nUNITS")).description.row_spacing);
    CHECK(decode(replaced(recording, "ROWS 3\n", "ROWS 3\r\n")).frames == found.frames);
}

TEST_CASE("tekscan_binary: split anywhere, the same comes out; cut anywhere, whole frames and no others") {
    CHECK(sensors_test::same_however_split(tekscan_binary(), bytes_of(recording)));
    CHECK(sensors_test::same_however_split(tekscan_binary(), bytes_of(header + first + "\x00\x00\xFF"s)));
    CHECK(sensors_test::only_whole_frames_when_cut(tekscan_binary(), bytes_of(recording)));
    const std::string cut = recording.substr(0, recording.size() - closing.size() - 1);
    CHECK(decode(cut).error ==
          "byte " + std::to_string(cut.size()) +
              ", frame 3: expected frames and a closing FF FE, found the end of the data "
              "(1 announced frames are missing)");
    CHECK(decode(cut).frames.size() == 2);
    CHECK(decode("ROWS 3\nCOLS 4\n").error ==
          "byte 14: expected a header that ends with the bytes 0A BB BA, found the end of the data");
}

TEST_CASE("tekscan_binary: what does not fit is an error with its place") {
    const auto error = [](const std::string& frames) {
        const decoded found = decode(header + frames);
        CHECK(found.status == decode_status::damaged);
        return found.error;
    };
    const std::string at = "byte " + std::to_string(header.size()),
                      missing = " (3 announced frames are missing)";
    CHECK(error("\x0C\x00\x01\x01"s) == at +
                                            ", frame 1: expected a run from cell 0 of 12 on, FFFF or, "
                                            "after a frame, FF FE, found cell 12" +
                                            missing);
    CHECK(error("\x0B\x00\x02\x01\x01"s).find("expected a run of 1 to 1 cells from cell 11, found 2") !=
          std::string::npos);
    CHECK(error("\x00\x00\x00"s).find("expected a run of 1 to 12 cells from cell 0, found 0") !=
          std::string::npos);
    CHECK(error("\x01\x00\x02\x01\x01\x02\x00\x01\x01"s).find("expected a run from cell 3 of 12") !=
          std::string::npos);
    CHECK(error(end_list + "\x01\x00\x03\x00"s).find("expected a record 1 of 4 bytes, found 3") !=
          std::string::npos);
    CHECK(error(end_list + "\x02\x00\x00\x00"s).find("expected a record 2 of 8 bytes, found 0") !=
          std::string::npos);
    CHECK(error(first + first).find("expected a frame after number 5, found number 5") != std::string::npos);
    CHECK(error(first + closing)
              .find("expected 3 frames as the header announces, found 1 before FF FE (2 ann") !=
          std::string::npos);
    CHECK(error(first + empty + third + empty)
              .find("expected 3 frames as the header announces, found one more") != std::string::npos);
    CHECK(error(first + empty + third + closing + "x").find("expected nothing after the closing FF FE") !=
          std::string::npos);
    // FF FE inside a frame is no end.
    CHECK(error("\x00\x00\x01\x01"s + closing).find("found cell 65279") != std::string::npos);
    CHECK(decode("COLS 4\n\xBB\xBA").error ==
          "byte 0, line 1: expected a line 'ROWS' in the header, found none");
    CHECK(decode("ROWS 255\nCOLS 256\n\xBB\xBA").error ==
          "byte 0, line 1: expected at most 65279 cells, found 255 x 256");
    CHECK(decode("ROWS 1\nCOLS 65279\n\xBB\xBA" + empty + closing).frames.at(0).cells.size() == 65279);
    CHECK(decode("ROWS x\nCOLS 4\n\xBB\xBA").status == decode_status::damaged);
}

TEST_CASE("tekscan_binary: the mask of a map") {
    std::vector<std::uint8_t> mask(12, 1);
    mask[3] = 0;
    const auto found = sensors_test::decode(tekscan_binary(mask), bytes_of(recording));
    CHECK(found.status == decode_status::finished);
    CHECK(found.description.missing_cells() == 1);
    mask[6] = 0;
    const auto refused = sensors_test::decode(tekscan_binary(mask), bytes_of(recording));
    CHECK(refused.frames.size() == 2);
    CHECK(refused.error.find("frame 3: expected counts on tactels of the map only, found one in cell 6") !=
          std::string::npos);
    CHECK(sensors_test::same_however_split(tekscan_binary(mask), bytes_of(recording)));
    const auto size =
        sensors_test::decode(tekscan_binary(std::vector<std::uint8_t>(11, 1)), bytes_of(recording));
    CHECK(size.error.find("expected the size of the map, 11 cells, found 3 x 4") != std::string::npos);
}

TEST_CASE("tekscan_binary: memory does not grow with the stream") {
    tekscan_binary decoder;
    decoder.push(bytes_of("ROWS 3\nCOLS 4\n\xBB\xBA" + first), tactnet::ignore_frames{});
    const std::string unnumbered = third,
                      record = end_list + "\x63\x00\xFF\xFF"s + std::string(65535, 'x') + end_list;
    const std::size_t before = support::bytes_allocated();
    for (int i = 0; i < 1000; ++i)
        REQUIRE(decoder.push(bytes_of(unnumbered), tactnet::ignore_frames{}) == decode_status::reading);
    REQUIRE(decoder.push(bytes_of(record), tactnet::ignore_frames{}) == decode_status::reading);
    CHECK(support::bytes_allocated() == before);
    CHECK(decoder.frames() == 1002);
    CHECK(decode(std::string(tactnet::largest_header_bytes + 1, 'x')).error ==
          "byte 262144: expected a header of at most 262144 bytes, found a longer one");
}

TEST_CASE("tekscan_binary: the real recording" * doctest::test_suite("data")) {
    const auto path = support::find_data("tekscan/MySampleRecording.fsx");
    if (!path)
        return;
    const auto bytes = tactnet::read_file(*path);
    const auto found = sensors_test::decode(tekscan_binary(), bytes);
    CHECK_MESSAGE(found.status == decode_status::finished, found.error);
    REQUIRE(found.frames.size() == 500);
    CHECK(found.description.rows == 44);
    CHECK(found.description.columns == 52);
    double sum = 0;
    for (std::size_t i = 0; i < found.frames.size(); ++i) {
        CHECK(found.frames[i].number == i + 1);
        sum = std::accumulate(found.frames[i].cells.begin(), found.frames[i].cells.end(), sum);
    }
    CHECK(sum == 476261); // counted apart, with another program
    CHECK(found.frames[0].cells[814] == 10);
    CHECK(found.frames[0].cells[815] == 12);
    CHECK(found.frames[1].seconds == 0.01);
    std::vector<std::size_t> every(bytes.size());
    std::iota(every.begin(), every.end(), std::size_t{0});
    CHECK(sensors_test::decode(tekscan_binary(), bytes, every).frames == found.frames);
    CHECK(sensors_test::only_whole_frames_when_cut(tekscan_binary(), bytes, 2999));
}

// A binary recording has no sum. How much damage is noticed all the same, and whether frames that are said to
// be certain are right.

using byte_vector = std::vector<std::byte>;

enum class damage { flipped_bit, cut_short, cut_out, swapped };
constexpr std::array kinds{
    std::pair(damage::flipped_bit, "flipped bit"), std::pair(damage::cut_short, "cut short"),
    std::pair(damage::cut_out, "range cut out"), std::pair(damage::swapped, "bytes swapped")};
constexpr std::size_t tries = 250; ///< of each kind

/// A number below `end`, the same on every machine, unlike those of the standard's distributions.
std::size_t below(std::mt19937_64& random, std::size_t end) {
    return static_cast<std::size_t>(random() % end);
}

/// Never what it was.
byte_vector damaged(const byte_vector& good, damage how, std::mt19937_64& random) {
    byte_vector result = good;
    while (result == good) {
        const std::size_t at = below(random, good.size());
        const auto place = result.begin() + static_cast<std::ptrdiff_t>(at);
        if (how == damage::flipped_bit)
            *place ^= std::byte{1} << below(random, 8);
        else if (how == damage::cut_short)
            result.resize(at);
        else if (how == damage::cut_out)
            result.erase(place, place + static_cast<std::ptrdiff_t>(
                                            std::min(good.size() - at, 1 + below(random, 400))));
        else
            std::swap(*place, result[(at + 1 + below(random, 64)) % good.size()]);
    }
    return result;
}

/// Whether two frames have the same number and time, and counts in the same cells.
bool only_counts_differ(const kept_frame& a, const kept_frame& b) {
    return a.number == b.number && a.seconds == b.seconds &&
           std::equal(a.cells.begin(), a.cells.end(), b.cells.begin(), b.cells.end(),
                      [](float x, float y) { return (x == 0) == (y == 0); });
}

/// All but the header's lines, most of which are never read.
bool same_description(const tactnet::recording_description& a, const tactnet::recording_description& b) {
    return a.version == b.version && a.rows == b.rows && a.columns == b.columns &&
           a.row_spacing == b.row_spacing && a.column_spacing == b.column_spacing &&
           a.cell_area == b.cell_area && a.saturation_pressure == b.saturation_pressure &&
           a.noise_threshold == b.noise_threshold && a.seconds_per_frame == b.seconds_per_frame &&
           a.frames == b.frames;
}

struct tally {
    std::size_t refused = 0, warned = 0;
    std::size_t harmless = 0, counts = 0, more = 0; ///< silent: nothing, counts alone, or more is wrong
    std::size_t wrong_whole = 0;   ///< refused or warned of, with a wrong frame among those that came out
    std::size_t wrong_certain = 0; ///< and with one among those that are said to be certain
    std::size_t certain = 0, right = 0; ///< frames of what was refused

    void add(const decoded& good, const decoded& found) {
        const std::size_t shared = std::min(good.frames.size(), found.frames.size());
        const auto end = good.frames.begin() + static_cast<std::ptrdiff_t>(shared);
        const auto same = static_cast<std::size_t>(
            std::mismatch(good.frames.begin(), end, found.frames.begin()).first - good.frames.begin());
        const bool is_refused = found.status == tactnet::decode_status::damaged;
        if (is_refused || !found.warnings.empty()) {
            ++(is_refused ? refused : warned);
            wrong_whole += found.frames.size() > same;
            wrong_certain += found.certain_frames > same;
            certain += is_refused ? found.certain_frames : 0;
            right += is_refused ? same : 0;
        } else if (!same_description(good.description, found.description) ||
                   !std::equal(good.frames.begin(), good.frames.end(), found.frames.begin(),
                               found.frames.end(), only_counts_differ)) {
            ++more;
        } else {
            ++(same == good.frames.size() ? harmless : counts);
        }
    }
};

std::array<tally, kinds.size()> attack(const byte_vector& good) {
    const decoded right = sensors_test::decode(tactnet::tekscan_binary(), good);
    REQUIRE_MESSAGE(right.status == tactnet::decode_status::finished, right.error);
    CHECK(right.warnings.empty());
    CHECK(right.certain_frames == right.frames.size());
    std::array<tally, kinds.size()> found{};
    std::mt19937_64 random(14);
    std::string table =
        "\ntried, refused, warned of, without effect, silent: counts changed, silent: more; told, "
        "but a frame wrong, a certain one; certain frames of what was refused, right ones";
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        tally& to = found[kind];
        for (std::size_t i = 0; i < tries; ++i)
            to.add(right,
                   sensors_test::decode(tactnet::tekscan_binary(), damaged(good, kinds[kind].first, random)));
        table += "\n" + std::string(kinds[kind].second) + ":";
        for (const std::size_t number : {tries, to.refused, to.warned, to.harmless, to.counts, to.more,
                                         to.wrong_whole, to.wrong_certain, to.certain, to.right})
            table += " " + std::to_string(number);
    }
    MESSAGE(table);
    return found;
}

/// A third of the bytes are counts, and nothing shows that a count became another. The rest that stays
/// silent is a run that moved within the gap between its neighbours, a digit of the header, or a whole run
/// that went missing.
void check(const std::array<tally, kinds.size()>& found) {
    constexpr std::array<std::size_t, kinds.size()> most_silent{95, 0, 3, 35},
        most_beyond_counts{21, 0, 3, 4};
    for (std::size_t kind = 0; kind < kinds.size(); ++kind) {
        CAPTURE(kinds[kind].second);
        CHECK(found[kind].counts + found[kind].more <= most_silent[kind]);
        CHECK(found[kind].more <= most_beyond_counts[kind]);
        CHECK(found[kind].wrong_certain == 0);
        // And not by saying that nothing is certain: a frame or two before the damage are missing.
        CHECK(found[kind].right - found[kind].certain <= 2 * found[kind].refused);
    }
}

TEST_CASE("tekscan_binary: damage of a written recording") {
    const std::string written = sensors_test::written_recording(60);
    const auto view = sensors_test::bytes_of(written);
    const auto found = attack({view.begin(), view.end()});
    check(found);
}

TEST_CASE("tekscan_binary: damage of the real recording" * doctest::test_suite("data")) {
    const auto path = support::find_data("tekscan/MySampleRecording.fsx");
    if (!path)
        return;
    const auto found = attack(tactnet::read_file(*path));
    check(found);
}

} // namespace
