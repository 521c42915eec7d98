#pragma once

// Of an array of tactels: its health and contacts, and what a simulation makes of it.

#include "interface.hpp"

#include <tactnet/decision/contact_detector.hpp>
#include <tactnet/decision/fault_list.hpp>
#include <tactnet/decision/gain_monitor.hpp>
#include <tactnet/runtime/saved_state.hpp>
#include <tactnet/simulation/contact/contact.hpp>

#include <cstdint>
#include <span>
#include <variant>

namespace tactnet_python {

/// Counts of frames one after the other.
using raw_frames =
    std::variant<std::span<const std::uint8_t>, std::span<const std::uint16_t>, std::span<const float>>;

struct sensor_settings {
    tactnet::count_scale scale;
    tactnet::health_settings health;
    tactnet::contact_settings contact;
};

/// Health and contacts of one sensor.
class any_sensor {
public:
    virtual ~any_sensor() = default;
    virtual void learn(const raw_frames& air) = 0;
    /// Cleans frames, and follows those of air.
    virtual void update(const raw_frames& raw, float* clean, tactnet::contact_state* contacts) = 0;
    virtual std::span<const tactnet::tactel_fault> faults() const = 0;
    virtual bool worn_out() const = 0;
    virtual std::uint8_t pressed() const = 0;
    virtual std::vector<std::byte> state() const = 0;
    virtual tactnet::restore_status restore(std::span<const std::byte> state) = 0;
};

/// A simulated sensor.
class any_scene {
public:
    virtual ~any_scene() = default;
    /// Simulates a frame of an object with these heights.
    virtual tactnet::simulation::contact_report touch(const float* heights,
                                                      const tactnet::simulation::pressing& press,
                                                      const tactnet::simulation::moment& now, float* clean,
                                                      float* measured) = 0;
    virtual void reset() = 0;
    tactnet::shape surface, tactels, output;
};

} // namespace tactnet_python
