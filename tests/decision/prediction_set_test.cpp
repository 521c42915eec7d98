#include <tactnet/decision/fitting.hpp>
#include <tactnet/decision/prediction_set.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

using namespace tactnet;

namespace {

constexpr std::size_t classes = 6;

struct samples {
    std::vector<float> logits;
    std::vector<std::size_t> labels;
};
/// Images that a network recognises not too well, and is too sure of.
samples draw(std::size_t count, std::mt19937& random) {
    std::normal_distribution<float> noise(0, 4);
    samples drawn;
    for (std::size_t i = 0; i < count; ++i) {
        drawn.labels.push_back(random() % classes);
        for (std::size_t c = 0; c < classes; ++c)
            drawn.logits.push_back(noise(random) + (c == drawn.labels.back() ? 10.0F : 0.0F));
    }
    return drawn;
}
std::string error_of(double coverage, std::span<const float> logits, std::span<const std::size_t> labels) {
    try {
        (void)fit_prediction_set({}, coverage, logits, classes, labels, classes);
    } catch (const std::invalid_argument& error) {
        return error.what();
    }
    return "";
}

} // namespace

TEST_CASE("prediction_set: holds the right class as often as promised, whatever the temperature") {
    std::mt19937 random(3);
    for (const double temperature : {0.3, 1.0, 5.0})
        for (const double coverage : {0.8, 0.95, 0.99}) {
            constexpr std::size_t draws = 60, images = 400;
            std::size_t held = 0, tried = 0, members_in_all = 0;
            for (std::size_t d = 0; d < draws; ++d) {
                const samples held_out = draw(200, random), test = draw(images, random);
                const auto set = fit_prediction_set({temperature}, coverage, held_out.logits, classes,
                                                    held_out.labels, classes);
                for (std::size_t i = 0; i < images; ++i) {
                    std::array<bool, classes> members{};
                    members_in_all +=
                        set.predict(std::span(test.logits).subspan(i * classes, classes), members);
                    held += members[test.labels[i]];
                }
                tried += images;
            }
            CAPTURE(temperature);
            CAPTURE(coverage);
            // Of n = 200 held-out images, the coverage has a deviation of √(coverage (1 − coverage) ÷ 202)
            // per draw.
            const double deviation =
                std::sqrt(coverage * (1 - coverage) * (1.0 / 202 / draws + 1.0 / static_cast<double>(tried)));
            const double found = static_cast<double>(held) / static_cast<double>(tried);
            CHECK(found >= coverage - 4 * deviation);
            // At most 1 ÷ 201 more than promised, but for the most likely class, which is always in.
            if (coverage > 0.9)
                CHECK(found <= coverage + 1.0 / 201 + 4 * deviation);
            CHECK(members_in_all >= tried);
        }
}

TEST_CASE("prediction_set: members by hand") {
    const prediction_set set({}, 0.2);
    std::array<bool, 3> members{true, true, true};
    const auto logarithm = [](double share) { return static_cast<float>(std::log(share)); };
    CHECK(set.predict(std::array{logarithm(0.5), logarithm(0.3), logarithm(0.19)}, members) == 2);
    CHECK(members == std::array{true, true, false});
    CHECK(set.predict(std::array{0.0F, std::numeric_limits<float>::quiet_NaN(), 0.0F}, members) == 0);
    CHECK(members == std::array{false, false, false});
    CHECK(set.predict(std::array{3000.0F, 2999.5F, 0.0F}, members) == 2); // no overflow
    const prediction_set sure({}, 0.99); // the most likely class all the same
    CHECK(sure.predict(std::array{0.0F, 1.0F, 0.0F}, members) == 1);
    CHECK(members == std::array{false, true, false});
}

TEST_CASE("prediction_set: of few images, all classes; of too few or wrong ones, an error") {
    std::mt19937 random(4);
    const samples few = draw(18, random);
    const auto all = fit_prediction_set({}, 0.95, few.logits, classes, few.labels, classes);
    CHECK(all.least_probability() == 0);
    std::array<bool, classes> members{};
    CHECK(all.predict(std::span(few.logits).first(classes), members) == classes);
    const samples enough = draw(19, random);
    CHECK(fit_prediction_set({}, 0.95, enough.logits, classes, enough.labels, classes).least_probability() >
          0);
    for (const double coverage : {0.0, 1.0, -1.0, std::numeric_limits<double>::quiet_NaN()})
        CHECK(error_of(coverage, few.logits, few.labels)
                  .starts_with("fit_prediction_set: expected a coverage above 0 and below 1, found"));
    CHECK(
        error_of(0.9, {}, {}).starts_with("fit_prediction_set: expected images with a row of 6 logits each"));
}
