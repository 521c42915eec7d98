#pragma once

#include <tactnet/decision/probabilities.hpp>
#include <tactnet/networks/recognition.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <span>

namespace tactnet { inline namespace TACTNET_ARCH {

/// How much observations of one object err together: 0 if they are independent, 1 if a further one says
/// nothing new.
struct touch_correlation {
    double frames = 1; ///< frames of one grasp
    /// Grasps of one object. Chosen by the validation images of 20 blocked splits of the paper's images, on
    /// which errors of neighbouring places agree.
    double grasps = 0.35;
};

/// What several frames of a grasp, and several grasps of the same object, say together. Log-probabilities are
/// summed, as of independent observations, and the sum of n is divided by 1 + (n − 1) ρ, where ρ is their
/// correlation (the design effect of Kish, 1965): frames within a grasp, then grasps.
///
///     touch_evidence<22> evidence(22, scaling);
///     evidence.add_frame(logits); … evidence.end_grasp();      // until the object is put down
///     if (const auto found = evidence.decide(0.01)) …          // at most 1 % wrong, for calibrated
///     probabilities
template <std::size_t Outputs>
class touch_evidence {
public:
    /// The first `classes` outputs stand for a class. Correlations are clamped to 0 … 1; NaN counts as 1.
    explicit touch_evidence(std::size_t classes = Outputs, const temperature_scaling& scaling = {},
                            const touch_correlation& correlation = {}) noexcept
        : classes_(std::clamp<std::size_t>(classes, 1, Outputs)),
          scaling_(scaling),
          correlation_{clamped(correlation.frames), clamped(correlation.grasps)} {}

    /// Takes the logits of the next frame of a grasp. Returns false, and takes nothing, if one is not finite
    /// or the temperature is none (is_temperature).
    bool add_frame(std::span<const float, Outputs> logits) noexcept {
        const std::span<const float> known = logits.first(classes_);
        const detail::value_range range(known);
        if (!range.finite || !is_temperature(scaling_.temperature))
            return false;
        const double scale = 1 / scaling_.temperature,
                     log_sum = std::log(detail::sum_of_exponentials(known, range.largest, scale));
        for (std::size_t c = 0; c < classes_; ++c)
            grasp_[c] +=
                (static_cast<double>(known[c]) - static_cast<double>(range.largest)) * scale - log_sum;
        ++frames_;
        return true;
    }
    /// What comes next is another grasp of the same object. Ends none without frames.
    void end_grasp() noexcept {
        if (frames_ == 0)
            return;
        for (std::size_t c = 0; c < classes_; ++c)
            before_[c] += grasp_[c] * share(frames_, correlation_.frames);
        grasp_ = {};
        frames_ = 0;
        ++grasps_;
    }
    /// What comes next is another object.
    void clear() noexcept {
        before_ = grasp_ = {};
        frames_ = grasps_ = 0;
    }

    /// How many grasps there are, with the present one if it has frames.
    [[nodiscard]] std::size_t grasps() const noexcept { return grasps_ + (frames_ > 0 ? 1 : 0); }
    /// The most likely class and its probability by all evidence so far; std::nullopt without any.
    [[nodiscard]] std::optional<recognition> most_likely() const noexcept {
        if (grasps() == 0)
            return std::nullopt;
        std::array<double, Outputs> sums{};
        const double of_grasp = share(frames_, correlation_.frames),
                     of_all = share(grasps(), correlation_.grasps);
        for (std::size_t c = 0; c < classes_; ++c)
            sums[c] = (before_[c] + grasp_[c] * of_grasp) * of_all;
        const auto known = std::span<const double>(sums).first(classes_);
        const auto best = std::max_element(known.begin(), known.end());
        return recognition{static_cast<std::size_t>(best - known.begin()),
                           1 / detail::sum_of_exponentials(known, *best, 1)};
    }
    /// The most likely class, once its probability is at least 1 − error_rate (a sequential test: Wald, 1945;
    /// for more than two classes: Baum and Veeravalli, 1994). The rate is kept as far as the probabilities
    /// are calibrated and the correlations right.
    [[nodiscard]] std::optional<recognition> decide(double error_rate) const noexcept {
        const std::optional<recognition> found = most_likely();
        return found && found->probability >= 1 - error_rate ? found : std::nullopt;
    }

private:
    [[nodiscard]] static double clamped(double correlation) noexcept {
        return correlation < 1 ? std::max(correlation, 0.0) : 1.0;
    }
    /// What a sum of correlated observations is multiplied by.
    [[nodiscard]] static double share(std::size_t count, double correlation) noexcept {
        return count > 1 ? 1 / (1 + static_cast<double>(count - 1) * correlation) : 1;
    }

    std::size_t classes_;
    temperature_scaling scaling_;
    touch_correlation correlation_;
    std::array<double, Outputs> before_{}, grasp_{}; ///< sums of log-probabilities
    std::size_t frames_ = 0, grasps_ = 0;
};

}} // namespace tactnet
