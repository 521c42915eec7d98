#pragma once

#include <tactnet/deployment/eight_bit.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

// The weights of a network on a page, where every byte is loaded over a network: what deployed<net,
// eight_bit> folds, with one byte per weight. Single precision computes with the same weights, so that they
// are stored once.

namespace browser {

/// Both sets of folded numbers, and the temperature of the probabilities.
template <class Network>
struct stored_network {
    using bytes_view = typename tactnet::deployed<Network, tactnet::eight_bit>::view_type;
    using float_view = typename tactnet::deployed<Network>::view_type;

    float temperature = 1;
    float scale = 1, limit = 1; ///< of the input in single precision
    std::vector<float> in_bytes = std::vector<float>(bytes_view::folded_elements);

    /// The folded numbers in single precision: of each step, the weights and the biases.
    [[nodiscard]] std::vector<float> in_floats() const {
        constexpr std::size_t pixels = Network::input_shape.size();
        std::vector<float> folded(in_bytes.begin(), in_bytes.begin() + pixels);
        folded.push_back(scale), folded.push_back(limit);
        for (const tactnet::folded_step& step : tactnet::folded_layout_of<bytes_view>().steps)
            for (const auto* array : {step.find("weight"), step.find("bias")})
                folded.insert(folded.end(), in_bytes.begin() + static_cast<std::ptrdiff_t>(array->offset),
                              in_bytes.begin() + static_cast<std::ptrdiff_t>(array->offset + array->size));
        return folded;
    }
};

/// Mean images are stored in 1/128 count, the precision with which networks in 8 bits read them.
inline constexpr float mean_steps = 128;

namespace detail {

/// Appends numbers to bytes, or takes them from there.
class byte_writer {
public:
    template <class Number>
    void move(Number& number) {
        const auto at = bytes.size();
        bytes.resize(at + sizeof(Number));
        std::memcpy(bytes.data() + at, &number, sizeof(Number));
    }
    void move_mean(float& mean) {
        auto steps = static_cast<std::uint16_t>(mean * mean_steps);
        move(steps);
    }
    void move_weight(float& weight, float scale) {
        auto steps = static_cast<std::int8_t>(std::nearbyint(weight / scale));
        move(steps);
    }

    std::vector<std::uint8_t> bytes{};
};
class byte_reader {
public:
    explicit byte_reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    template <class Number>
    void move(Number& number) {
        complete_ = complete_ && bytes_.size() >= sizeof(Number);
        if (!complete_)
            return;
        std::memcpy(&number, bytes_.data(), sizeof(Number));
        bytes_ = bytes_.subspan(sizeof(Number));
    }
    void move_mean(float& mean) {
        std::uint16_t steps = 0;
        move(steps);
        mean = static_cast<float>(steps) / mean_steps;
    }
    void move_weight(float& weight, float scale) {
        std::int8_t steps = 0;
        move(steps);
        weight = static_cast<float>(steps) * scale;
    }
    /// Whether there were enough bytes for all that was asked for.
    [[nodiscard]] bool complete() const { return complete_; }
    [[nodiscard]] std::span<const std::uint8_t> rest() const { return bytes_; }

private:
    std::span<const std::uint8_t> bytes_;
    bool complete_ = true;
};

/// Scales and ranges come before the weights, which need them.
template <class Network, class Bytes>
void move_network(stored_network<Network>& network, Bytes& bytes) {
    constexpr std::size_t pixels = Network::input_shape.size();
    bytes.move(network.temperature), bytes.move(network.scale), bytes.move(network.limit);
    for (std::size_t pixel = 0; pixel < pixels; ++pixel)
        bytes.move_mean(network.in_bytes[pixel]);
    bytes.move(network.in_bytes[pixels]), bytes.move(network.in_bytes[pixels + 1]);
    using view = typename stored_network<Network>::bytes_view;
    for (const tactnet::folded_step& step : tactnet::folded_layout_of<view>().steps) {
        for (const auto& array : step.arrays)
            for (std::size_t i = 0; array.kind != tactnet::folded_kind::weights && i < array.size; ++i)
                bytes.move(network.in_bytes[array.offset + i]);
        // Tap by tap: those that meet nothing but padding are zeros in one piece.
        const auto &weights = *step.find("weight"), &scales = *step.find("scale");
        const std::size_t of_filter = weights.size / scales.size,
                          taps = weights.extents[2] * weights.extents[3];
        for (std::size_t tap = 0; tap < taps; ++tap)
            for (std::size_t i = tap; i < weights.size; i += taps)
                bytes.move_weight(network.in_bytes[weights.offset + i],
                                  network.in_bytes[scales.offset + i / of_filter]);
    }
}

} // namespace detail
} // namespace browser
