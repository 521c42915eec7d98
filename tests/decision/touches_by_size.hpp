#pragma once

// What sensor_health and contact_detector with their defaults make of the paper's touches at the size of an
// array, and of its noisy air. For a test and for a benchmark.

#include <tactnet/decision/contact_detector.hpp>
#include <tactnet/decision/sensor_health.hpp>
#include <tactnet/image/resize.hpp>
#include <tactnet/io/images/set.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <random>
#include <span>
#include <vector>

namespace touches_by_size {

using namespace tactnet;

template <shape Array>
using frame = std::array<std::uint8_t, Array.size()>;

/// Health and contact, as a control loop runs them.
template <shape Array>
struct stage {
    sensor_health<Array> health{};
    contact_detector<Array> detector{};
    std::size_t contacts = 0;

    void learn(const frame<Array>& air) {
        health.learn(air);
        detector.learn(health.clean(air));
    }
    /// Whether the clean frame has the counts of `raw`.
    bool unaltered(const frame<Array>& raw) {
        const auto clean = health.clean(raw);
        const contact_state& now = detector.update(clean);
        contacts += now.began;
        if (!now.touching)
            health.follow(raw);
        return std::equal(clean.begin(), clean.end(), raw.begin());
    }
};

struct result {
    std::size_t touches = 0, felt = 0, altered = 0;
    double held = 0; ///< the least share of its force that is left of a touch after 5000 frames
};

/// Each touch lasts 30 frames, with 10 of air before it. One sensor for all, which never forgets.
template <shape Array>
result of_touches(const image_set& images) {
    stage<Array> robot;
    for (int i = 0; i < 50; ++i)
        robot.learn({});
    result found{.touches = images.size(), .held = 1};
    for (std::size_t i = 0; i < images.size(); ++i) {
        const auto reduced =
            resize_bicubic(images.image(i), images.rows, images.columns, Array.rows, Array.columns);
        frame<Array> raw{};
        std::copy_n(reduced.begin(), raw.size(), raw.begin());
        const std::size_t before = robot.contacts;
        for (int f = 0; f < 10; ++f)
            (void)robot.unaltered({});
        bool altered = false;
        for (int f = 0; f < 30; ++f)
            altered = !robot.unaltered(raw) || altered;
        found.felt += robot.contacts > before;
        found.altered += altered;
        if (i % 50 == 0) { // one of each class
            stage<Array> holds;
            std::uint32_t first = 0, last = 0;
            for (int f = 0; f < 5000; ++f) {
                (void)holds.unaltered(raw);
                last = holds.detector.now().force;
                first = f == 0 ? last : first;
            }
            found.held = std::min(found.held, static_cast<double>(last) / first);
        }
    }
    return found;
}

/// Contacts found in frames of air with Gaussian noise of `deviation` counts, and offsets of tactels up
/// to 20.
template <shape Array>
std::size_t contacts_in_air(double deviation, std::size_t frames, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal(0, deviation);
    std::vector<float> noise(65536);
    for (float& value : noise)
        value = static_cast<float>(normal(random));
    std::array<float, Array.size()> offset{};
    for (float& value : offset)
        value = static_cast<float>(random() % 20);
    stage<Array> robot;
    frame<Array> air{};
    for (std::size_t f = 0; f < frames + 50; ++f) {
        std::uint64_t bits = 0;
        for (std::size_t i = 0; i < air.size(); ++i, bits >>= 16U) {
            if (i % 4 == 0)
                bits = random();
            air[i] = static_cast<std::uint8_t>(
                std::clamp(std::round(offset[i] + noise[bits & 0xFFFFU]), 0.0F, 255.0F));
        }
        if (f < 50)
            robot.learn(air);
        else
            (void)robot.unaltered(air);
    }
    return robot.contacts;
}

} // namespace touches_by_size
