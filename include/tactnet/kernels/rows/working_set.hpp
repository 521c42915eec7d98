#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <array>
#include <cstddef>
#include <limits>

// The inner loops of sequential minimal optimisation. The gradient is in double, since its size grows with
// the cost of an error while its tolerance does not. Arrays are aligned, and padded to whole vectors with
// samples that may not move.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// A sample and the value by which it was selected.
struct selected_sample {
    double value;
    std::size_t index;
};

namespace detail {

/// The largest values so far and their places, lane by lane; the first of equal values.
class lane_maximum {
public:
    void offer(const vector<double>& values) {
        const mask<double> larger = values > values_;
        values_ = choose<double>(larger, values, values_);
        places_ = choose<double>(larger, place_, places_);
        place_ += vector<double>(1.0);
    }
    [[nodiscard]] selected_sample best() const {
        constexpr std::size_t width = lanes<double>;
        alignas(vector_alignment) std::array<double, width> values, places;
        store(values.data(), values_);
        store(places.data(), places_);
        selected_sample result{-std::numeric_limits<double>::infinity(), 0};
        for (std::size_t lane = 0; lane < width; ++lane) {
            const std::size_t index = static_cast<std::size_t>(places[lane]) * width + lane;
            if (values[lane] > result.value || (values[lane] == result.value && index < result.index))
                result = {values[lane], index};
        }
        return result;
    }

private:
    vector<double> values_ = vector<double>(-std::numeric_limits<double>::infinity());
    vector<double> places_ = vector<double>(0.0), place_ = vector<double>(0.0);
};

} // namespace detail

/// The sample of largest gradient + `up`, where `up` is 0 for samples that may rise and −∞ for others.
[[nodiscard]] inline selected_sample steepest(const double* gradient, const double* up, std::size_t count) {
    detail::lane_maximum best;
    for (std::size_t i = 0; i < count; i += lanes<double>)
        best.offer(load(gradient + i) + load(up + i));
    return best.best();
}

/// gradient −= step · (rising − falling), rows of the kernel matrix; then `steepest`.
[[nodiscard]] inline selected_sample update_gradient(double* gradient, const float* rising,
                                                     const float* falling, double step, const double* up,
                                                     std::size_t count) {
    const vector<double> s(-step);
    detail::lane_maximum best;
    for (std::size_t i = 0; i < count; i += lanes<double>) {
        const vector<double> g = multiply_add(s, widen(rising + i) - widen(falling + i), load(gradient + i));
        store(gradient + i, g);
        best.offer(g + load(up + i));
    }
    return best.best();
}

/// The sample that falls while another rises, and how far the pair is from the optimum.
struct selected_partner {
    selected_sample sample; ///< its value is twice the gain of a step without bounds
    double lowest;          ///< the smallest gradient among samples that may fall
};

/// Second-order choice (Fan, Chen, Lin, "Working set selection using second order information for training
/// SVM", JMLR 6, 2005): largest (g_i − g_t)² / (K_ii + K_tt − 2 K_it). `low` is 0 for samples that may fall
/// and +∞ for others. `row` is the kernel row of the rising sample, `own` its K_ii.
[[nodiscard]] inline selected_partner select_partner(const double* gradient, const double* low,
                                                     const float* row, const double* diagonal, double own,
                                                     double rising, double least_curvature,
                                                     std::size_t count) {
    using v = vector<double>;
    const v minus_two(-2.0), k(own), top(rising), least(least_curvature), none(-1.0), zero(0.0);
    detail::lane_maximum best;
    v lowest(std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < count; i += lanes<double>) {
        const v g = load(gradient + i) + load(low + i), b = top - g;
        const v curvature = multiply_add(minus_two, widen(row + i), k + load(diagonal + i));
        const v a = choose<double>(curvature > least, curvature, least);
        best.offer(choose<double>(b > zero, b * b / a, none));
        lowest = choose<double>(g < lowest, g, lowest);
    }
    alignas(vector_alignment) std::array<double, lanes<double>> flat;
    store(flat.data(), lowest);
    double smallest = flat[0];
    for (const double value : flat)
        smallest = value < smallest ? value : smallest;
    return {best.best(), smallest};
}

}}} // namespace tactnet::kernels
