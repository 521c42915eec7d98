#include <tactnet/runtime/random.hpp>
#include <tactnet/training/data/neighbours.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

namespace {

using namespace tactnet;

constexpr shape size{20, 9, 1};

/// Two classes, recordings of four frames each; the frames of a recording are alike if `recorded`.
struct touches {
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels, groups;

    touches(std::size_t recordings, bool recorded) {
        for (std::size_t i = 0; i < 2 * recordings * 4; ++i) {
            labels.push_back(i / (recordings * 4));
            groups.push_back(i / 4);
            random_stream still(1, random_purposes::order, 0,
                                static_cast<std::uint32_t>(recorded ? i / 4 : i)),
                moving(1, random_purposes::order, 1, static_cast<std::uint32_t>(i));
            for (std::size_t e = 0; e < size.size(); ++e)
                pixels.push_back(static_cast<std::uint8_t>(still.below(200) + moving.below(9)));
        }
    }
    neighbour_report report(bool by_group, std::span<const std::size_t> tested,
                            std::span<const std::size_t> others) const {
        return compare_neighbours(
            {pixels, labels, 2}, size,
            by_group ? std::span<const std::size_t>(groups) : std::span<const std::size_t>(), tested, others);
    }
    neighbour_report report(bool by_group) const {
        std::vector<std::size_t> all(labels.size());
        std::iota(all.begin(), all.end(), std::size_t{0});
        return report(by_group, all, all);
    }
};

} // namespace

TEST_CASE("compare_neighbours: recordings are found, by their order and by groups") {
    const touches found(15, true);
    for (const bool by_group : {false, true}) {
        const neighbour_report report = found.report(by_group);
        CHECK(report.tested == 120);
        CHECK(report.too_easy());
        CHECK(report.expected == doctest::Approx(by_group ? 120 * 3.0 / 59 : (116 * 2.0 + 4) / 59));
        CHECK(report.related.size() > (by_group ? 118 : 55));
        CHECK(report.recognised == 1);
        CHECK(report.without_related < 0.75); // classes are chance, once recordings are taken away
        for (const auto& [image, nearest, distance] : report.related) {
            CHECK(found.groups[image] == found.groups[nearest]);
            CHECK(distance < 6);
        }
        CHECK(std::is_sorted(report.related.begin(), report.related.end(),
                             [](const auto& a, const auto& b) { return a.distance < b.distance; }));
    }
}

TEST_CASE("compare_neighbours: nothing is found where frames have nothing in common") {
    const neighbour_report report = touches(15, false).report(false);
    CHECK(!report.too_easy());
    CHECK(report.recognised < 0.75);
}

TEST_CASE("compare_neighbours: a test of whole groups is not too easy, one that cuts them is") {
    const touches found(15, true);
    std::vector<std::size_t> even, odd, first, last;
    for (std::size_t i = 0; i < 120; ++i) {
        (i % 2 == 0 ? even : odd).push_back(i);
        (i / 4 % 2 == 0 ? first : last).push_back(i);
    }
    CHECK(found.report(true, even, odd).too_easy());
    CHECK(found.report(false, even, odd).too_easy());
    const neighbour_report honest = found.report(true, first, last);
    CHECK(!honest.too_easy());
    CHECK(honest.related.empty());
    CHECK(honest.recognised == honest.without_related);
}

TEST_CASE("compare_neighbours: outliers and classes of one image are left out") {
    const std::vector<std::uint8_t> pixels(4 * size.size());
    const std::vector<std::size_t> labels{0, 0, 1, no_class}, all{0, 1, 2, 3};
    const neighbour_report report = compare_neighbours({pixels, labels, 2}, size, {}, all, all);
    CHECK(report.tested == 2);
    CHECK(!report.too_easy());
    CHECK(compare_neighbours({pixels, labels, 2}, size, {}, {}, all).tested == 0);
}

TEST_CASE("neighbour_report: is too easy from twice the pairs of chance on, by five deviations") {
    const auto too_easy = [](std::size_t found, std::size_t tested, double expected) {
        neighbour_report report;
        report.tested = tested, report.expected = expected;
        report.related.resize(found);
        return report.too_easy();
    };
    CHECK(too_easy(13'000, 20'000, 6000));
    CHECK(!too_easy(7000, 20'000, 6000)); // many deviations, but hardly more than by chance
    CHECK(!too_easy(9, 20, 3));           // few images
}
