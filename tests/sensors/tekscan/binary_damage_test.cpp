#include "../decoded.hpp"
#include "written_recording.hpp"

#include <tactnet/io/read_file.hpp>
#include <tactnet/sensors/tekscan/binary.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <support/files/data_folder.hpp>
#include <utility>
#include <vector>

// A binary recording has no sum. How much damage is noticed all the same, and whether frames that are said to
// be certain are right.

using sensors_test::decoded;
using sensors_test::kept_frame;

namespace {

using bytes = std::vector<std::byte>;

enum class damage { flipped_bit, cut_short, cut_out, swapped };
constexpr std::array kinds{
    std::pair(damage::flipped_bit, "flipped bit"), std::pair(damage::cut_short, "cut short"),
    std::pair(damage::cut_out, "range cut out"), std::pair(damage::swapped, "bytes swapped")};
constexpr std::size_t tries = 250; ///< of each kind

/// The same on every machine, unlike the standard's distributions.
std::size_t below(std::mt19937_64& random, std::size_t end) {
    return static_cast<std::size_t>(random() % end);
}

/// Never what it was.
bytes damaged(const bytes& good, damage how, std::mt19937_64& random) {
    bytes result = good;
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

/// The same number and time, and counts in the same cells.
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

std::array<tally, kinds.size()> attack(const bytes& good) {
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

/// A third of the bytes are counts, and nothing shows that a count became another. The rest that stays silent
/// is a run that moved within the gap between its neighbours, a digit of the header, or a whole run that went
/// missing.
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

} // namespace

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
