#pragma once

// A life of an array, from air to a touch to a broken row, played through all that decides in the control
// loop. The same on any machine: what is integer to the bit, probabilities nearly.

#include <tactnet/decision/contact_detector.hpp>
#include <tactnet/decision/discriminant.hpp>
#include <tactnet/decision/gain_monitor.hpp>
#include <tactnet/decision/probabilities.hpp>
#include <tactnet/decision/sensor_health.hpp>
#include <tactnet/decision/touch_evidence.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace decisions {

inline constexpr tactnet::shape array{28, 50};
using frame = std::array<std::uint8_t, array.size()>;

/// 40 frames of air; then ten of a touch and ten of air by turns, with a row that is stuck from frame 80 on.
inline void make_frame(std::size_t number, frame& counts) noexcept {
    const bool touch = number >= 40 && number / 10 % 2 == 0;
    for (std::size_t row = 0; row < array.rows; ++row)
        for (std::size_t column = 0; column < array.columns; ++column) {
            const int y = static_cast<int>(row) - 14, x = static_cast<int>(column) - 20;
            const int pressure = touch ? std::max(0, 150 - 3 * (y * y + x * x)) : 0;
            const auto noise = static_cast<int>((number * 7 + row * 5 + column * 3) % 11 / 5);
            counts[row * array.columns + column] =
                static_cast<std::uint8_t>(number >= 80 && row == 4 ? 255 : pressure + noise);
        }
}

struct outcome {
    std::uint64_t checksum = 0; ///< of clean frames, contacts and faults
    std::uint32_t label = 0, members = 0;
    double probability = 0, gain = 0;

    /// Whether two machines agree.
    [[nodiscard]] bool agrees(const outcome& other) const noexcept {
        const auto near = [](double a, double b) { return a - b < 1e-9 && b - a < 1e-9; };
        return checksum == other.checksum && label == other.label && members == other.members &&
               near(probability, other.probability) && near(gain, other.gain);
    }
};

/// All of it, in static memory.
class life {
public:
    static constexpr std::size_t frames = 120;

    outcome play() noexcept {
        health_.forget();
        for (std::size_t number = 0; number < frames; ++number) {
            make_frame(number, raw_);
            number < 20 ? health_.learn(raw_) : take_frame();
        }
        const auto found = evidence_.most_likely();
        std::array<bool, 22> members{};
        const std::size_t count = tactnet::prediction_set({0.7}, 0.05).predict(logits_of(area_), members);
        const auto nearest = means_.nearest({1, 2});
        tactnet::xxh64 checksum;
        checksum.update(std::as_bytes(std::span(&sum_, 1))).update(health_.save());
        return {checksum.digest(), static_cast<std::uint32_t>(found ? found->index : 99),
                static_cast<std::uint32_t>(count + (nearest ? 100 * nearest->index : 5000)),
                found ? found->probability : 0, gain_.gain()};
    }
    /// The latest frame once more, and one of a touch.
    bool repeat() noexcept {
        take_frame();
        return detector_.now().frames > 0;
    }
    void begin_touch() noexcept {
        make_frame(45, raw_);
        for (int i = 0; i < 5; ++i)
            take_frame();
    }

private:
    void take_frame() noexcept {
        const auto clean = health_.clean(raw_);
        const tactnet::contact_state& contact = detector_.update(clean);
        for (const std::uint8_t count : clean)
            sum_ = sum_ * 31 + count;
        sum_ = sum_ * 31 + contact.area + 7 * contact.touching + 131 * contact.force;
        if (!contact.touching) {
            health_.follow(raw_);
            return;
        }
        area_ = contact.area;
        gain_.add_touch(contact.force);
        evidence_.add_frame(logits_of(contact.area));
        (void)means_.learn(contact.area % 3, {static_cast<float>(contact.area % 5), 1});
    }
    static std::array<float, 22> logits_of(std::uint32_t area) noexcept {
        std::array<float, 22> logits{};
        for (std::size_t c = 0; c < logits.size(); ++c)
            logits[c] = static_cast<float>((area * 7 + c * 13) % 29) / 8;
        return logits;
    }

    tactnet::sensor_health<array> health_;
    tactnet::contact_detector<array> detector_;
    tactnet::gain_monitor gain_{tactnet::force_statistics{9, 0.5}};
    tactnet::touch_evidence<22> evidence_{22, {0.7}};
    tactnet::class_means<2, 4> means_;
    frame raw_{};
    std::uint64_t sum_ = 0;
    std::uint32_t area_ = 0;
};

} // namespace decisions
