#pragma once

// What a network's form in 8 bits has that is compiled for its type and size, as virtual functions. See
// compile.hpp for the template behind it.

#include "methods/networks/any_model.hpp"
#include "methods/networks/compiled.hpp"

#include <tactnet/deployment/eight_bit/layout.hpp>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

/// What calibration found.
struct calibrated_numbers {
    std::vector<float> folded;
    /// Roots of mean squares of what outputs differ by from those in single precision, on the images: with
    /// these weights, and with merely rounded ones.
    double output_error, output_error_of_rounded;
};

class compiled_eight_bit {
public:
    virtual ~compiled_eight_bit() = default;

    /// Of the folded numbers.
    virtual tactnet::folded_layout layout() const = 0;
    /// Of a model, with ranges and weights by images one behind the other. Throws std::invalid_argument for a
    /// model that has no form in 8 bits.
    virtual calibrated_numbers calibrate(const any_model& model,
                                         std::span<const std::uint8_t> images) const = 0;
    /// Throws std::invalid_argument for numbers that cannot be.
    virtual std::unique_ptr<any_deployed> deploy(std::span<const float> folded) const = 0;
};
