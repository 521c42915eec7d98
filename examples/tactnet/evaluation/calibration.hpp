#pragma once

// How well the probabilities of a network agree with how often it is right.

#include "data/image_data.hpp"
#include "methods/method.hpp"

#include <tactnet/decision/reliability_diagram.hpp>
#include <tactnet/decision/temperature_scaling.hpp>

#include <cstddef>
#include <optional>
#include <span>

/// Fits a temperature to the results on images that a network was not trained on. Nothing without such
/// images, and for methods without probabilities.
std::optional<tactnet::temperature_scaling> fit_temperature(const tactnet::evaluation& held_out,
                                                            std::span<const std::size_t> images,
                                                            const image_data& data);

struct calibration {
    tactnet::temperature_scaling scaling{};
    /// Of the same images, by the softmax and by the scaled one; empty for methods without probabilities.
    tactnet::reliability_diagram before{}, after{};
};

calibration calibration_of(const tactnet::evaluation& result, std::span<const std::size_t> images,
                           const image_data& data, const tactnet::temperature_scaling& scaling);
