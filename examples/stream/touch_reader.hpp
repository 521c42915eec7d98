#pragma once

// From a frame of the sensor to what a robot acts on: is anything touching, what is it, how sure is that, and
// which tactels can no longer be trusted.

#include "own_device.hpp"

#include <tactnet/decision.hpp>
#include <tactnet/sensors/frame.hpp>
#include <tactnet/tactnet.hpp>

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

inline constexpr tactnet::shape frame_shape{own_device::rows, own_device::columns};
using touch_network = tactnet::tactnet6<frame_shape, 22>;

/// What a frame says.
struct answer {
    enum class state {
        unreadable, ///< another size, or numbers that no network takes
        learning,   ///< air, which the baseline is learnt from
        air,        ///< nothing touches the array
        touch
    };
    state says = state::unreadable;
    std::uint64_t number = 0;
    std::optional<double> seconds{};                 ///< of the source
    std::optional<tactnet::recognition> found{};     ///< by all frames of the touch so far
    std::optional<tactnet::contact_state> contact{}; ///< where air was learnt
    std::span<const tactnet::tactel_fault> faults{}; ///< valid until the next frame
    std::span<const std::uint8_t> counts{};          ///< without baseline and faults, likewise
    double microseconds = 0;                         ///< that the answer took
};

class touch_reader {
public:
    /// The first `frames_of_air` frames teach what the array counts when nothing touches it. Without any,
    /// each frame is recognised by itself, and no tactel is looked after.
    touch_reader(const tactnet::deployed<touch_network>& network, std::size_t frames_of_air)
        : deployed_(network),
          classes_(network.class_count()),
          frames_of_air_(frames_of_air),
          evidence_(classes_, {network.temperature()}) {}

    answer read(const tactnet::frame_view& frame) {
        answer result{.number = frame.number, .seconds = frame.seconds};
        const auto counts = frame.counts<frame_shape>();
        const auto start = std::chrono::steady_clock::now();
        if (frames_of_air_ == 0)
            recognise_alone(frame, result);
        else if (counts)
            recognise_touch(counts->view().elements(), result);
        const std::chrono::duration<double, std::micro> time = std::chrono::steady_clock::now() - start;
        result.microseconds = time.count();
        if (frames_of_air_ == 0 && counts) {
            counts_ = *counts;
            result.counts = counts_.view().elements();
        }
        return result;
    }

private:
    void recognise_alone(const tactnet::frame_view& frame, answer& result) {
        std::array<float, touch_network::outputs> logits;
        const auto cells = frame.as<frame_shape>();
        if (!cells || deployed_.infer(*cells, logits) != tactnet::frame_status::ok)
            return;
        evidence_.clear();
        evidence_.add_frame(logits);
        result.says = answer::state::touch;
        result.found = evidence_.most_likely();
    }

    void recognise_touch(std::span<const std::uint8_t, frame_shape.size()> raw, answer& result) {
        if (learnt_ < frames_of_air_) {
            ++learnt_;
            health_.learn(raw);
            detector_.learn(health_.clean(raw));
            result.says = answer::state::learning;
            return;
        }
        const auto clean = health_.clean(raw);
        const tactnet::contact_state& contact = detector_.update(clean);
        result.contact = contact;
        result.faults = health_.faults();
        result.counts = clean;
        result.says = contact.touching ? answer::state::touch : answer::state::air;
        if (!contact.touching) {
            health_.follow(raw);
            evidence_.clear(); // what comes next may be another object
            return;
        }
        std::array<float, touch_network::outputs> logits;
        if (contact.firm && deployed_.infer(clean, logits) == tactnet::frame_status::ok)
            evidence_.add_frame(logits);
        result.found = evidence_.most_likely();
    }

    tactnet::deployed<touch_network> deployed_;
    std::size_t classes_, frames_of_air_, learnt_ = 0;
    tactnet::sensor_health<frame_shape> health_;
    tactnet::contact_detector<frame_shape> detector_;
    tactnet::touch_evidence<touch_network::outputs> evidence_;
    tactnet::tensor<std::uint8_t, frame_shape> counts_{};
};
