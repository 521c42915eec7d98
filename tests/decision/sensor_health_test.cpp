#include <tactnet/decision/sensor_health.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <span>
#include <support/allocations.hpp>
#include <support/summed.hpp>
#include <type_traits>
#include <utility>
#include <vector>

using namespace tactnet;

namespace {

constexpr shape array{28, 50};
using frame = std::array<std::uint8_t, array.size()>;
using health = sensor_health<array>;

/// A smooth touch, 15 × 17 tactels wide, whose highest count is 170.
frame touch(std::size_t row = 14, std::size_t column = 25) {
    frame counts{};
    for (std::size_t r = 0; r < 28; ++r)
        for (std::size_t c = 0; c < 50; ++c) {
            const int y = static_cast<int>(r) - static_cast<int>(row),
                      x = static_cast<int>(c) - static_cast<int>(column);
            counts[r * 50 + c] = static_cast<std::uint8_t>(std::max(0, 170 - 2 * (y * y + x * x)));
        }
    return counts;
}
frame cleaned(health& of, const frame& raw) {
    frame result{};
    std::copy_n(of.clean(raw).begin(), result.size(), result.begin());
    return result;
}
int largest_difference(const frame& a, const frame& b) {
    int largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, std::abs(int{a[i]} - int{b[i]}));
    return largest;
}

} // namespace

TEST_CASE("sensor_health: a sound array changes nothing") {
    health sensor;
    for (int i = 0; i < 300; ++i) {
        CHECK(cleaned(sensor, touch()) == touch());
        CHECK(cleaned(sensor, frame{}) == frame{});
    }
    CHECK(sensor.faults().empty());
    CHECK(sensor.frames() == 600);
    CHECK(sensor.mean_baseline() == 0);
}

TEST_CASE("sensor_health: the baseline is the mean of frames of air, and is subtracted") {
    health sensor;
    std::mt19937 random(1);
    frame offset{};
    for (std::uint8_t& count : offset)
        count = static_cast<std::uint8_t>(random() % 30);
    for (int i = 0; i < 100; ++i) {
        frame air = offset;
        for (std::uint8_t& count : air)
            count = static_cast<std::uint8_t>(count + (i % 2 == 0 ? 1 : 0)); // 0.5 on average
        sensor.learn(air);
    }
    frame raw = touch();
    for (std::size_t i = 0; i < raw.size(); ++i)
        raw[i] = static_cast<std::uint8_t>(raw[i] + offset[i]);
    CHECK(largest_difference(cleaned(sensor, raw), touch()) <= 1);
    CHECK(sensor.mean_baseline() == doctest::Approx(14.5 + 0.5).epsilon(0.03));
    sensor.forget();
    CHECK(cleaned(sensor, raw) == raw);
}

TEST_CASE("sensor_health: a stuck row, column and single tactels are replaced at once, and reported after "
          "some frames") {
    for (const std::uint8_t stuck_at : {std::uint8_t{128}, std::uint8_t{255}})
        for (const char kind : {'r', 'c', 's'}) {
            std::vector<std::size_t> places;
            for (std::size_t i = 0; i < (kind == 'r' ? 50 : kind == 'c' ? 28 : 14); ++i)
                places.push_back(kind == 'r'   ? 3 * 50 + i
                                 : kind == 'c' ? i * 50 + 44
                                               : 50 * (1 + 2 * (i % 13)) + 3 * i + 2);
            const auto broken = [&](frame raw) {
                for (const std::size_t place : places)
                    raw[place] = stuck_at;
                return raw;
            };
            health sensor;
            CHECK(cleaned(sensor, broken({})) == frame{}); // the first frame already
            CHECK(sensor.faults().empty());
            for (int i = 1; i < 16; ++i)
                CHECK(cleaned(sensor, broken({})) == frame{});
            REQUIRE(sensor.faults().size() == places.size());
            for (const tactel_fault& fault : sensor.faults()) {
                CHECK(std::find(places.begin(), places.end(), fault.row * 50U + fault.column) !=
                      places.end());
                CHECK(fault.kind == tactel_fault_kind::stuck);
                CHECK(fault.since == 15);
            }
            CHECK(sensor.row_is_faulty(3) == (kind == 'r'));
            CHECK(sensor.column_is_faulty(44) == (kind == 'c'));
            CHECK_FALSE(sensor.row_is_faulty(4));
            CHECK_FALSE(sensor.worn_out());
            // Under an object, where no spike shows them, they are replaced by the mean of their neighbours.
            CHECK(largest_difference(cleaned(sensor, broken(touch(6, 42))), touch(6, 42)) <= 20);
        }
}

TEST_CASE("sensor_health: dead tactels are found under objects, and recover") {
    health sensor;
    frame dead = touch();
    for (const std::size_t column : {22U, 23U, 24U, 25U, 26U, 27U})
        dead[14 * 50 + column] = 0; // part of a row
    CHECK(largest_difference(cleaned(sensor, dead), touch()) <= 20);
    for (int i = 0; i < 20; ++i) {
        (void)sensor.clean(dead);
        (void)sensor.clean(frame{}); // air says nothing about dead tactels
    }
    REQUIRE(sensor.faults().size() == 6);
    for (const tactel_fault& fault : sensor.faults()) {
        CHECK(fault.kind == tactel_fault_kind::dead);
        CHECK(fault.row == 14);
    }
    for (int i = 0; i < 199; ++i) {
        (void)sensor.clean(touch());
        (void)sensor.clean(frame{});
    }
    CHECK(sensor.faults().size() == 6);
    (void)sensor.clean(dead); // fails again: the count of frames starts again
    for (int i = 0; i < 199; ++i)
        (void)sensor.clean(touch());
    CHECK(sensor.faults().size() == 6);
    (void)sensor.clean(touch());
    CHECK(sensor.faults().empty());
    CHECK(cleaned(sensor, touch()) == touch());
}

TEST_CASE("sensor_health: a stuck tactel that moves again is used again, also one that learn has found") {
    for (const bool learns : {false, true}) {
        health_settings settings;
        settings.follow =
            200; // so fast that what was learnt of the stuck tactel comes below largest_baseline
        health sensor(settings);
        frame stuck{};
        stuck[700] = 200;
        for (int i = 0; i < 20; ++i)
            learns ? sensor.learn(stuck) : static_cast<void>(sensor.clean(stuck));
        REQUIRE(sensor.faults().size() == 1);
        CHECK(sensor.faults()[0].row == 14);
        CHECK(sensor.faults()[0].column == 0);
        CHECK(cleaned(sensor, stuck) == frame{});
        for (int i = 0; i < 200; ++i) {
            sensor.follow(frame{});
            (void)sensor.clean(frame{});
        }
        CHECK(sensor.faults().empty());
        frame pressed = touch(14, 3);
        CHECK(cleaned(sensor, pressed) == pressed);
    }
}

TEST_CASE("sensor_health: of several faulty tactels, each recovers by itself, and may fail again") {
    frame both{}, second{};
    both[3 * 50 + 5] = both[20 * 50 + 40] = second[20 * 50 + 40] = 255;
    health sensor;
    for (int i = 0; i < 20; ++i)
        (void)sensor.clean(both);
    REQUIRE(sensor.faults().size() == 2);
    for (int i = 0; i < 150; ++i)
        (void)sensor.clean(frame{});
    (void)sensor.clean(second); // starts again
    for (int i = 0; i < 50; ++i)
        (void)sensor.clean(frame{});
    REQUIRE(sensor.faults().size() == 1);
    CHECK(sensor.faults()[0].row == 20);
    CHECK(sensor.faults()[0].column == 40);
    CHECK(cleaned(sensor, touch(3, 5)) == touch(3, 5)); // the first is used again
    for (int i = 0; i < 148; ++i)
        (void)sensor.clean(frame{});
    CHECK(sensor.faults().size() == 1);
    (void)sensor.clean(frame{});
    CHECK(sensor.faults().empty());
    for (int i = 0; i < 15; ++i)
        (void)sensor.clean(second);
    CHECK(sensor.faults().empty());
    for (int i = 0; i < 15; ++i)
        (void)sensor.clean(second);
    CHECK(sensor.faults().size() == 1);
    CHECK(sensor.faults()[0].since == 386);
}

TEST_CASE("sensor_health: an offset that all tactels have in common is followed, in air and in a contact") {
    for (const frame& under : {frame{}, touch()}) {
        health sensor;
        frame raw = under;
        for (std::uint8_t& count : raw)
            count = static_cast<std::uint8_t>(std::min(255, count + 8));
        for (int i = 0; i < 8; ++i)
            (void)sensor.clean(raw);
        CHECK(cleaned(sensor, raw) == under);
        CHECK(sensor.mean_baseline() == 8);
        for (int i = 0; i < 8; ++i)
            (void)sensor.clean(under);
        CHECK(cleaned(sensor, under) == under);
        CHECK(sensor.mean_baseline() == 0);
    }
}

TEST_CASE("sensor_health: the lowest quarter of an array is its baseline") {
    health sensor;
    frame raw{};
    raw.fill(8);
    for (int i = 0; i < 8; ++i)
        (void)sensor.clean(raw);
    REQUIRE(sensor.mean_baseline() == 8);
    raw.fill(100);
    std::fill_n(raw.begin(), 349, std::uint8_t{0});
    (void)sensor.clean(raw); // too many are pressed: the offset rises
    CHECK(sensor.mean_baseline() == 9);
    raw[349] = 0;
    (void)sensor.clean(raw);
    CHECK(sensor.mean_baseline() == 8);
}

TEST_CASE("sensor_health: a contact of ten minutes is not taken for air") {
    health sensor;
    for (int i = 0; i < 60'000; ++i)
        (void)sensor.clean(touch()); // follow is not called: a contact is known
    CHECK(cleaned(sensor, touch()) == touch());
}

TEST_CASE("sensor_health: follow moves the baseline by its step, up and down, to the counts of air") {
    health_settings settings;
    settings.follow = 128; // half a count per frame
    health sensor(settings);
    frame air{};
    air.fill(5);
    for (int i = 0; i < 4; ++i)
        sensor.follow(air);
    CHECK(sensor.mean_baseline() == 2);
    for (int i = 0; i < 20; ++i)
        sensor.follow(air);
    CHECK(sensor.mean_baseline() == 5);
    sensor.follow(air); // stays
    CHECK(sensor.mean_baseline() == 5);
    CHECK(cleaned(sensor, air) == frame{});
    for (int i = 0; i < 20; ++i)
        sensor.follow(frame{});
    CHECK(sensor.mean_baseline() == 0);
}

TEST_CASE("sensor_health: an array with too many faults is worn out, and still gives frames") {
    health sensor;
    frame broken{};
    for (std::size_t row = 1; row < 28; row += 3)
        for (std::size_t column = 0; column < 50; ++column)
            broken[row * 50 + column] = 255;
    for (int i = 0; i < 100; ++i)
        (void)sensor.clean(broken);
    CHECK(sensor.worn_out());
    CHECK(sensor.faults().size() == health::max_faults);
    // Spikes are replaced all the same, except one next to those that the list has no room for.
    const frame found = cleaned(sensor, broken);
    CHECK(std::count(found.begin(), found.end(), 0) >= 1399);
}

TEST_CASE("sensor_health: on a small array, whole rows and columns, pairs and single tactels are found") {
    constexpr shape small{7, 13};
    using small_frame = std::array<std::uint8_t, small.size()>;
    small_frame pressed{};
    for (std::size_t i = 0; i < pressed.size(); ++i)
        pressed[i] = static_cast<std::uint8_t>(120 + i % 13);
    const auto faults_at = [&](const std::vector<std::size_t>& places, const small_frame& under,
                               std::uint8_t count, int frames = 16) {
        sensor_health<small> sensor;
        small_frame broken = under;
        for (const std::size_t place : places)
            broken[place] = count;
        for (int i = 0; i < frames; ++i)
            (void)sensor.clean(broken);
        return sensor.faults().size();
    };
    std::vector<std::size_t> row, column;
    for (std::size_t i = 0; i < 11; ++i) // as many as can be faulty
        row.push_back(3 * 13 + i);
    for (std::size_t i = 0; i < 7; ++i)
        column.push_back(i * 13 + 4);
    CHECK(faults_at(column, {}, 255) == 7);
    CHECK(faults_at(column, pressed, 0) == 5);                           // all but its ends
    CHECK(faults_at(row, {}, 255) == 2);                                 // of part of a row, its ends
    CHECK(faults_at({40, 41, 42, 43, 44, 45}, pressed, 0, 3 * 16) == 6); // of a dead one, then those between
    row.push_back(3 * 13 + 11), row.push_back(3 * 13 + 12);
    CHECK(faults_at(row, {}, 255) == sensor_health<small>::max_faults);
    CHECK(faults_at({30, 31, 80}, {}, 200) == 3);
    CHECK(faults_at({30, 56}, pressed, 0) == 2);
}

TEST_CASE("sensor_health: follow leaves a pressed tactel as it is, and counts the offset of all") {
    health sensor;
    frame raw{};
    raw.fill(20);
    for (int i = 0; i < 20; ++i)
        (void)sensor.clean(raw);
    REQUIRE(sensor.mean_baseline() == 20);
    raw[700] = 28; // pressed by 8
    raw[701] = 27;
    for (int i = 0; i < 256; ++i)
        sensor.follow(raw);
    for (int i = 0; i < 5; ++i) // the offset of all falls by what the baseline rose
        (void)sensor.clean(raw);
    const frame clean = cleaned(sensor, raw);
    CHECK(clean[700] == 9);
    CHECK(clean[701] == 7);
    CHECK(clean[702] == 0);
}

TEST_CASE("sensor_health: calls do not allocate, for arrays of any size") {
    const auto check = []<shape Array>(std::integral_constant<shape, Array>) {
        std::mt19937 random(Array.rows);
        std::array<std::uint8_t, Array.size()> raw{};
        sensor_health<Array> sensor;
        const std::size_t before = support::allocations();
        for (int i = 0; i < 200; ++i) {
            for (std::uint8_t& count : raw)
                count = static_cast<std::uint8_t>(random() % 256);
            if (i < 5)
                sensor.learn(raw);
            (void)sensor.clean(raw);
            sensor.follow(raw);
        }
        CHECK(support::allocations() == before);
    };
    check(std::integral_constant<shape, shape{7, 13}>{});
    check(std::integral_constant<shape, shape{1, 1}>{});
    check(std::integral_constant<shape, shape{3, 200}>{});
    check(std::integral_constant<shape, shape{100, 100}>{});
}

TEST_CASE("sensor_health: what was saved goes on as if nothing had happened") {
    health before;
    std::mt19937 random(5);
    const auto air = [&](bool broken) {
        frame counts{};
        for (std::size_t i = 0; i < counts.size(); ++i)
            counts[i] = static_cast<std::uint8_t>(i % 7 + random() % 3);
        if (broken)
            for (std::size_t column = 0; column < 50; ++column)
                counts[9 * 50 + column] = 255;
        return counts;
    };
    for (int i = 0; i < 50; ++i)
        before.learn(air(false));
    for (int i = 0; i < 30; ++i)
        (void)cleaned(before, air(true));
    REQUIRE(before.faults().size() == 50);

    const auto state = before.save();
    static_assert(noexcept(before.save()));
    health after;
    const std::size_t allocated = support::allocations();
    CHECK(after.restore(state) == restore_status::ok);
    CHECK(support::allocations() == allocated);
    CHECK(after.save() == state);
    CHECK(after.frames() == before.frames());
    CHECK(after.mean_baseline() == before.mean_baseline());
    REQUIRE(after.faults().size() == 50);
    CHECK(after.faults()[7].row == before.faults()[7].row);
    CHECK(after.faults()[7].since == before.faults()[7].since);
    CHECK(after.row_is_faulty(9));
    for (int i = 0; i < 300; ++i) { // also those in which the row recovers
        const frame next = air(i < 20);
        CHECK(cleaned(after, next) == cleaned(before, next));
        if (i % 3 == 0)
            after.follow(next), before.follow(next);
    }
    CHECK(after.faults().empty());
    CHECK(before.faults().empty());
}

TEST_CASE("sensor_health: a state that is damaged, cut or of another array changes nothing") {
    health saved, other;
    for (int i = 0; i < 20; ++i) {
        frame air{};
        air[3 * 50 + 4] = 255;
        air[10 * 50 + 10] = 255;
        saved.learn(air);
        other.learn(frame{});
    }
    REQUIRE(saved.faults().size() == 2);
    const auto state = saved.save(), kept = other.save();
    CHECK(other.restore(std::span(state).first(state.size() - 1)) == restore_status::other_size);
    CHECK(other.restore({}) == restore_status::other_size);
    CHECK(other.restore(sensor_health<shape{27, 50}>().save()) == restore_status::other_size);
    CHECK(other.restore(sensor_health<shape{50, 28}>().save()) == restore_status::other_state); // as large
    for (std::size_t byte = 0; byte < state.size(); ++byte) {
        auto damaged = state;
        damaged[byte] ^= std::byte{4};
        const restore_status found = other.restore(damaged);
        CHECK(found == (byte < 16 ? restore_status::other_state : restore_status::damaged));
    }
    // Numbers that no state has, under a right checksum.
    CHECK(other.restore(support::summed(state)) == restore_status::ok);
    CHECK(other.restore(kept) == restore_status::ok);
    const std::size_t faults = 16 + 13 + 2 * array.size(); // overflowed, count, then 13 bytes for each
    // Of the list of faults; and more frames learnt than count, a level above a byte, an overflow without
    // faults, one found in the future.
    for (const auto& [place, value] : std::vector<std::pair<std::size_t, int>>{{faults, 2},
                                                                               {faults + 1, 255},
                                                                               {faults + 4, 1},
                                                                               {faults + 5, 28},
                                                                               {faults + 7, 50},
                                                                               {faults + 9, 2},
                                                                               {faults + 5 + 13, 3},
                                                                               {18, 2},
                                                                               {19, 255},
                                                                               {16 + 13 + 2 * 154, 1},
                                                                               {faults, 1},
                                                                               {faults + 5 + 13 + 12, 1}}) {
        auto wrong = state;
        wrong[place] = static_cast<std::byte>(value);
        if (place == faults + 5 + 13) // the same tactel twice
            wrong[place + 2] = std::byte{4};
        const std::size_t changed = place; // Clang 14 captures no structured binding
        CAPTURE(changed);
        CHECK(other.restore(support::summed(wrong)) == restore_status::damaged);
    }
    CHECK(other.save() == kept);
    // As many frames as can be counted: what is saved after more of them is restored, too.
    auto most = state;
    std::fill_n(most.begin() + 20, 8, std::byte{0xFF});
    REQUIRE(saved.restore(support::summed(most)) == restore_status::ok);
    (void)cleaned(saved, frame{});
    CHECK(other.restore(saved.save()) == restore_status::ok);
    // As many faults as there can be, and one more: nothing behind the bytes is read, as a sanitizer sees.
    std::vector<std::byte> full(state.begin(), state.end());
    std::fill(full.begin() + static_cast<std::ptrdiff_t>(faults), full.end(), std::byte{0});
    full[faults] = std::byte{1};
    for (std::size_t f = 0; f < health::max_faults; ++f) {
        full[faults + 5 + 13 * f] = static_cast<std::byte>(f / 50);
        full[faults + 5 + 13 * f + 2] = static_cast<std::byte>(f % 50);
    }
    for (const std::size_t count : {health::max_faults, health::max_faults + 1}) {
        full[faults + 1] = static_cast<std::byte>(count);
        CHECK((other.restore(support::summed(full)) == restore_status::ok) == (count == health::max_faults));
    }
    CHECK(describe(restore_status::damaged) == "expected the bytes that were saved, found damage");
}
