#pragma once

#include <tactnet/sensors/frame.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

// From counts to pressure. The count of a tactel is proportional to the pressure on it, up to the pressure at
// which the converter saturates. Equilibration, a recording under even pressure, measures by how much each
// tactel differs from the mean. Counts within the noise are no contact.

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {
/// The nearest finite float of a number above zero.
[[nodiscard]] inline float to_float(double value) noexcept {
    return static_cast<float>(std::min(value, static_cast<double>(std::numeric_limits<float>::max())));
}
} // namespace detail

/// Parameters of a calibration. Their defaults change nothing.
struct calibration_values {
    double saturation_pressure = 0; ///< pascal at full_scale
    /// The largest count. The published reader of the 6077 divides 8-bit counts by 256.
    double full_scale = 255;
    double noise_threshold = 0; ///< counts up to this one become zero
    std::vector<float> gains{}; ///< one per cell, row by row; empty: all 1
};

/// Converts raw frames to pascal without heap use. Safe to share between threads.
class calibration {
public:
    /// Throws std::invalid_argument unless pressure, full scale and gains are positive and finite, and the
    /// threshold is not negative.
    explicit calibration(calibration_values values) : values_(std::move(values)) {
        require("a saturation pressure", values_.saturation_pressure);
        require("a full scale", values_.full_scale);
        for (const float gain : values_.gains)
            require("gains", static_cast<double>(gain));
        if (!(values_.noise_threshold >= 0))
            detail::throw_invalid_argument({"calibration: expected a noise threshold of zero or more, found ",
                                            std::to_string(values_.noise_threshold)});
    }

    /// Creates the calibration that a recording describes. Returns nothing if it is in pascal or has no
    /// saturation pressure. The noise threshold of a recording has already been applied. Without a full scale
    /// of the recording, it is 255.
    [[nodiscard]] static std::optional<calibration> from(const recording_description& description) {
        if (description.unit != pressure_unit::raw || !(description.saturation_pressure.value_or(0) > 0))
            return std::nullopt;
        return calibration({.saturation_pressure = *description.saturation_pressure,
                            .full_scale = description.full_scale.value_or(255)});
    }

    /// Creates the calibration of a 6077. The published reader has a `full_scale` of 256.
    [[nodiscard]] static calibration for_6077(double full_scale = 255) {
        return calibration(
            {.saturation_pressure = tekscan_6077::saturation_pressure, .full_scale = full_scale});
    }

    /// Writes the pressure on each cell to `to`: at most the largest float, NaN of a broken cell. If the
    /// sizes of `counts`, `to` and the gains differ, returns false and writes nothing.
    [[nodiscard]] bool to_pascal(std::span<const float> counts, std::span<float> to) const noexcept {
        if (counts.size() != to.size() || (!values_.gains.empty() && values_.gains.size() != to.size()))
            return false;
        const double scale = values_.saturation_pressure / values_.full_scale;
        for (std::size_t i = 0; i < to.size(); ++i) {
            const double gain = values_.gains.empty() ? 1 : static_cast<double>(values_.gains[i]);
            const auto count = static_cast<double>(counts[i]);
            to[i] = count <= values_.noise_threshold ? 0.0f
                    : std::isnan(count)              ? counts[i]
                                                     : detail::to_float(count * gain * scale);
        }
        return true;
    }

    [[nodiscard]] const calibration_values& values() const noexcept { return values_; }

private:
    static void require(const char* what, double value) {
        if (!(value > 0 && std::isfinite(value)))
            detail::throw_invalid_argument(
                {"calibration: expected ", what, " above zero, found ", std::to_string(value)});
    }

    calibration_values values_;
};

/// Computes the gains that equalise the mean frame of a recording under even pressure: the mean over all
/// tactels divided by each tactel. Cells without a tactel get 1. Throws std::invalid_argument if a tactel is
/// zero or not finite.
[[nodiscard]] inline std::vector<float> equilibration_gains(std::span<const float> mean_frame,
                                                            const recording_description& description) {
    if (mean_frame.size() != description.cells())
        detail::throw_invalid_argument(
            {"equilibration_gains: expected ", description.cells(), " cells, found ", mean_frame.size()});
    double sum = 0;
    std::size_t tactels = 0;
    for (std::size_t i = 0; i < mean_frame.size(); ++i) {
        if (!description.exists(i))
            continue;
        if (!(mean_frame[i] > 0 && std::isfinite(mean_frame[i])))
            detail::throw_invalid_argument(
                {"equilibration_gains: expected a count above zero in every tactel, found ",
                 std::to_string(mean_frame[i]), " in cell ", i});
        sum += static_cast<double>(mean_frame[i]);
        ++tactels;
    }
    std::vector<float> gains(mean_frame.size(), 1.0f);
    for (std::size_t i = 0; i < gains.size(); ++i)
        if (description.exists(i))
            gains[i] =
                detail::to_float(sum / static_cast<double>(tactels) / static_cast<double>(mean_frame[i]));
    return gains;
}

}} // namespace tactnet
