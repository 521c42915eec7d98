#include <tactnet/sensors/tekscan/binary_checks.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

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
                const std::size_t taken = records.take(rest.first(std::min(piece, rest.size())));
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
        CHECK(records.take(bytes) == length);
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
