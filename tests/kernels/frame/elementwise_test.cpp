#include <tactnet/kernels/frame/elementwise.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <random>

// From counts to numbers: whole vectors, one that reaches back over its neighbour, fewer than one.

using namespace tactnet;
using namespace tactnet::kernels;

namespace {

template <std::size_t... Sizes>
struct sizes {};
using some_sizes = sizes<1, 2, 3, 4, 5, 7, 8, 9, 15, 16, 17, 31, 32, 33, 48, 91, 350>;

constexpr float scale = 0.37f, limit = 40;

/// One more number than there are counts lies at both ends, so that no vector of them is aligned, and what is
/// written outside them is seen.
template <class Count, std::size_t Size>
struct drawn_frame {
    std::array<Count, Size + 1> counts;
    std::array<float, Size + 1> mean;
    std::array<float, Size + 2> numbers;

    drawn_frame() {
        std::mt19937 draw(Size);
        for (std::size_t i = 0; i <= Size; ++i) {
            counts[i] = static_cast<Count>(draw() % 100);
            mean[i] = static_cast<float>(draw() % 6400) / 64;
        }
        numbers.fill(-7);
    }
    bool usual() {
        return normalise_counts<Size>(counts.data() + 1, mean.data() + 1, scale, limit, numbers.data() + 1);
    }
    [[nodiscard]] std::size_t wrong() const {
        std::size_t differing = numbers[0] != -7 || numbers[Size + 1] != -7;
        for (std::size_t i = 1; i <= Size; ++i) {
            // In steps, each rounded once.
            const float apart = static_cast<float>(counts[i]) - mean[i];
            differing += numbers[i] != apart * scale;
        }
        return differing;
    }
};

template <class Body, std::size_t... Sizes>
void for_each_size(sizes<Sizes...>, const Body& body) {
    (body(constant<Sizes>{}), ...);
}

} // namespace

TEST_CASE_TEMPLATE("normalise_counts: any number of counts", Count, std::uint8_t, float) {
    for_each_size(some_sizes{}, [](auto size) {
        CAPTURE(size());
        drawn_frame<Count, size()> frame;
        CHECK(frame.usual());
        CHECK(frame.wrong() == 0);
    });
}

TEST_CASE("normalise_counts: bytes up to the largest, of which no limit is asked") {
    drawn_frame<std::uint8_t, 33> frame;
    frame.counts.fill(255), frame.mean.fill(100);
    CHECK(frame.usual());
    CHECK(frame.wrong() == 0);
}

TEST_CASE("normalise_counts: NaN and counts beyond the limit are reported at every place") {
    constexpr float largest = std::numeric_limits<float>::max(),
                    infinity = std::numeric_limits<float>::infinity();
    for_each_size(some_sizes{}, [](auto size) {
        CAPTURE(size());
        for (std::size_t place = 1; place <= size(); ++place) {
            CAPTURE(place);
            drawn_frame<float, size()> frame;
            frame.mean[place] = 0;
            const auto usual_with = [&](float count) {
                frame.counts[place] = count;
                return frame.usual();
            };
            for (const float count : {std::nanf(""), infinity, -infinity, largest, -largest,
                                      limit / scale + 1, -limit / scale - 1})
                CHECK_FALSE(usual_with(count));
            for (const float count : {0.0f, limit / scale - 1, 1 - limit / scale})
                CHECK(usual_with(count));
        }
    });
}

TEST_CASE("normalise_counts: the limit itself is within, wherever it is") {
    for_each_size(some_sizes{}, [](auto size) {
        CAPTURE(size());
        for (std::size_t place = 1; place <= size(); ++place)
            for (const float count : {3.0f, -3.0f}) {
                drawn_frame<float, size()> frame;
                frame.counts.fill(1), frame.mean.fill(0);
                frame.counts[place] = count;
                const auto usual_within = [&](float most) {
                    return normalise_counts<size()>(frame.counts.data() + 1, frame.mean.data() + 1, 1, most,
                                                    frame.numbers.data() + 1);
                };
                CHECK(usual_within(3));
                CHECK_FALSE(usual_within(std::nextafter(3.0f, 0.0f)));
            }
    });
}
