#include <tactnet/kernels/frame/tactels.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

using namespace tactnet::kernels;

namespace {

std::vector<std::uint8_t> random_counts(std::size_t size, std::uint32_t seed) {
    std::mt19937 random(seed);
    std::vector<std::uint8_t> counts(size);
    for (std::uint8_t& count : counts)
        count = static_cast<std::uint8_t>(random() & 0xFF);
    return counts;
}

template <std::size_t Size>
void check_levels() {
    for (const unsigned each : {0U, 1U, 100U, 255U}) {
        const auto offset = static_cast<std::uint8_t>(each);
        const auto counts = random_counts(Size, 1 + each), levels = random_counts(Size, 2 + each);
        auto found = counts;
        const level_tally tally = subtract_levels<Size>(found.data(), levels.data(), offset);
        std::size_t wrong = 0, above = 0, below = 0;
        for (std::size_t i = 0; i < Size; ++i) {
            const int level = std::min(255, levels[i] + offset);
            wrong += found[i] != std::max(0, counts[i] - level);
            above += counts[i] > level;
            below += counts[i] < level;
        }
        CHECK(wrong == 0);
        CHECK(tally.above == above);
        CHECK(tally.below == below);
    }
}

template <std::size_t Size, std::size_t Stride>
void check_signs() {
    const sign_limits limits{60, 40, 120, 5};
    for (std::uint32_t seed = 0; seed < 20; ++seed) {
        auto counts = random_counts(Size + 2 * Stride + 2, seed);
        for (std::uint8_t& count : counts) // many low and many pressed ones
            count = count < 100 ? static_cast<std::uint8_t>(count / 12) : count;
        std::vector<std::uint8_t> signs(Size);
        const bool any = find_suspects<Size, Stride>(counts.data(), limits, signs.data());
        std::size_t wrong = 0, found = 0;
        for (std::size_t i = 0; i < Size; ++i) {
            const int own = counts[i + Stride + 1];
            int low = 0, pressed = 0;
            for (std::size_t y = 0; y < 3; ++y)
                for (std::size_t x = 0; x < 3; ++x)
                    if (y != 1 || x != 1) {
                        low += counts[i + y * Stride + x] < own / 8;
                        pressed += counts[i + y * Stride + x] >= limits.pressed;
                    }
            const int expected = own >= limits.spike && low >= limits.neighbours      ? spike_sign
                                 : own <= limits.hole && pressed >= limits.neighbours ? hole_sign
                                                                                      : 0;
            wrong += signs[i] != expected;
            found += signs[i] != 0;
        }
        CHECK(wrong == 0);
        CHECK(any == (found != 0));
        CHECK((Size < 1000 || found > 0));
    }
}

/// One spike and one hole at each place of an array of zeros or of pressed tactels, and with each number of
/// neighbours that speak for it, corners first and corners last.
void check_lone_signs() {
    constexpr std::size_t stride = 15, size = whole_count_vectors(7 * stride);
    constexpr std::array<std::size_t, 8> corners_last{1, 3, 4, 6, 0, 2, 5, 7};
    const sign_limits limits{100, 0, 20, 6};
    std::size_t wrong = 0;
    for (const bool hole : {false, true})
        for (const bool reversed : {false, true})
            for (std::size_t place = 0; place < size; ++place)
                for (std::size_t speak = 0; speak <= 8; ++speak) {
                    std::vector<std::uint8_t> counts(size + 2 * stride + 2, hole ? 9 : 50), signs(size);
                    counts[place + stride + 1] = hole ? 0 : 100;
                    for (std::size_t n = 0; n < speak; ++n)
                        counts[place + neighbour_distances<stride>[corners_last[reversed ? 7 - n : n]]] =
                            hole ? 20 : 11;
                    const bool any = find_suspects<size, stride>(counts.data(), limits, signs.data());
                    const std::uint8_t expected = speak < 6 ? std::uint8_t{0} : hole ? hole_sign : spike_sign;
                    wrong += any != (speak >= 6) || signs[place] != expected;
                }
    CHECK(wrong == 0);
}

template <std::size_t Size>
void check_pressed() {
    for (const unsigned each : {1U, 8U, 200U, 255U}) {
        const auto pressed = static_cast<std::uint8_t>(each);
        const auto counts = random_counts(Size, each);
        const pressed_tally tally = tally_pressed<Size>(counts.data(), pressed);
        std::size_t area = 0, force = 0;
        for (const std::uint8_t count : counts)
            if (count >= pressed)
                ++area, force += count;
        CHECK(tally.area == area);
        CHECK(tally.force == force);
    }
    const std::vector<std::uint8_t> all(Size, 255);
    CHECK(tally_pressed<Size>(all.data(), 1).area == Size);
    CHECK(tally_pressed<Size>(all.data(), 1).force == 255 * Size);
}

} // namespace

TEST_CASE("subtract_levels: each count less its level and the offset, for any number of vectors") {
    check_levels<count_lanes>();
    check_levels<whole_count_vectors(28 * 52)>();
    check_levels<300 * count_lanes>(); // more than a byte counts
}

TEST_CASE("find_suspects: spikes and holes, as a loop over neighbours finds them") {
    check_signs<count_lanes, 5>();
    check_signs<whole_count_vectors(28 * 52), 52>();
    check_signs<whole_count_vectors(7 * 15), 15>();
    check_lone_signs();
}

TEST_CASE("tally_pressed: area and force of pressed tactels, for any number of tactels") {
    check_pressed<1>();
    check_pressed<7 * 13>();
    check_pressed<28 * 50>();
    check_pressed<count_lanes>();
    check_pressed<127 * count_lanes>();
    check_pressed<128 * count_lanes>();
    check_pressed<129 * count_lanes>();
    check_pressed<254 * count_lanes + 3>();
    check_pressed<20'000>();
}
