#pragma once

// What a ROS 2 node does with a pressure image. It knows no ROS, so that it can be tested without:
// touch_node.cpp is the node.

#include <tactnet/decision.hpp>
#include <tactnet/tactnet.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

/// What a touch is so far; without a touch, the label is empty.
struct touch_report {
    bool touching = false;
    std::string_view label{};
    double probability = 0;
};

template <class Network>
class touch_core {
public:
    static constexpr tactnet::shape array = Network::input_shape;

    /// Nothing may touch the array during the first `air_frames` images.
    explicit touch_core(tactnet::deployed<Network> network, std::size_t air_frames = 50)
        : network_(std::move(network)),
          evidence_(network_.class_count(), tactnet::temperature_scaling{network_.temperature()}),
          air_frames_(air_frames) {}

    /// Reads an image of sensor_msgs/Image with encoding "mono8": `height` rows of `width` counts, `step`
    /// bytes apart. Returns nothing while it learns the array in air, and for an image of another size.
    std::optional<touch_report> read(std::size_t height, std::size_t width, std::size_t step,
                                     std::span<const std::uint8_t> data) noexcept {
        if (height != array.rows || width != array.columns || step < width || data.size() / step < height)
            return std::nullopt;
        std::array<std::uint8_t, array.size()> raw;
        for (std::size_t row = 0; row < height; ++row)
            std::copy_n(data.data() + row * step, width, raw.data() + row * width);
        if (air_frames_ > 0) {
            --air_frames_;
            health_.learn(raw);
            detector_.learn(health_.clean(raw));
            return std::nullopt;
        }
        const auto clean = health_.clean(raw);
        const tactnet::contact_state& contact = detector_.update(clean);
        if (!contact.touching) {
            health_.follow(raw);
            evidence_.clear(); // what comes next may be another object
            return touch_report{};
        }
        std::array<float, Network::outputs> logits;
        if (contact.firm && network_.infer(clean, logits) == tactnet::frame_status::ok)
            evidence_.add_frame(logits);
        touch_report report{.touching = true};
        if (const auto found = evidence_.most_likely()) {
            report.label = network_.classes()[found->index];
            report.probability = found->probability;
        }
        return report;
    }

private:
    tactnet::deployed<Network> network_;
    tactnet::sensor_health<array> health_;
    tactnet::contact_detector<array> detector_;
    tactnet::touch_evidence<Network::outputs> evidence_;
    std::size_t air_frames_;
};
