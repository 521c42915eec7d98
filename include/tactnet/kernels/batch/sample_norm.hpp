#pragma once

#include <tactnet/kernels/norm_groups.hpp>
#include <tactnet/kernels/simd/in_double.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <cstddef>

// Group, instance and layer norms of a lane block. Each sample has moments of its own: lanes never mix.
// Everything is computed in double and rounded once, so that neither a mean far from zero nor a large or tiny
// deviation costs accuracy. `lanes<double>` samples at a time; pointers to elements point to the first of
// them.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// The mean and 1 ÷ √(variance + epsilon) of a group.
struct group_moments {
    vector<double> mean, inverse_deviation;

    /// Reads or writes them for the samples of a lane block of `Lanes`: means, then inverse deviations.
    template <std::size_t Lanes>
    [[nodiscard]] static group_moments read(const double* from) {
        return {load(from), load(from + Lanes)};
    }
    template <std::size_t Lanes>
    void write(double* to) const {
        store(to, mean), store(to + Lanes, inverse_deviation);
    }
};

/// The moments of a group, in two passes. The second also corrects the mean (Chan, Golub and LeVeque,
/// "Algorithms for computing the sample variance", 1983).
template <class T>
[[nodiscard]] group_moments moments_of_group(const norm_groups& groups, double epsilon, const T* in) {
    const vector<double> count(static_cast<double>(groups.size())), zero(0.0);
    vector<double> sum = zero, rest = zero, squares = zero;
    groups.for_each([&](std::size_t e) { sum = sum + load_double(in + e * lanes<T>); });
    const vector<double> center = sum / count;
    groups.for_each([&](std::size_t e) {
        const vector<double> d = load_double(in + e * lanes<T>) - center;
        rest = rest + d;
        squares = multiply_add<double>(d, d, squares);
    });
    rest = rest / count;
    const vector<double> variance = squares / count - rest * rest;
    return {center + rest,
            vector<double>(1.0) / square_root<double>(choose<double>(variance < zero, zero, variance) +
                                                      vector<double>(epsilon))};
}

/// out = (in − mean) ÷ deviation × weight + bias, for the elements of a group.
template <class T>
void normalise_group(const norm_groups& groups, const group_moments& moments, const T* weights,
                     const T* biases, const T* in, T* out) {
    for (std::size_t c = 0; c < groups.channels; ++c) {
        const vector<double> scale =
            vector<double>(static_cast<double>(weights[c])) * moments.inverse_deviation;
        const vector<double> bias(static_cast<double>(biases[c]));
        groups.for_each_pixel(c, [&](std::size_t e) {
            const vector<double> distance = load_double(in + e * lanes<T>) - moments.mean;
            store_double(out + e * lanes<T>, multiply_add<double>(distance, scale, bias));
        });
    }
}

/// The backward pass of `normalise_group`. Adds to `totals` the gradients of each weight and its bias,
/// [weight][weight, bias][lane of double], and sets the gradient of the input unless it is null.
template <class T>
void normalise_group_backward(const norm_groups& groups, const group_moments& moments, const T* weights,
                              const T* in, const T* out_gradient, T* in_gradient, double* totals) {
    const auto normalised = [&](std::size_t e) {
        return (load_double(in + e * lanes<T>) - moments.mean) * moments.inverse_deviation;
    };
    vector<double> level(0.0), slope(0.0); // of the whole group
    for (std::size_t c = 0; c < groups.channels; ++c) {
        vector<double> of_weight(0.0), of_bias(0.0);
        groups.for_each_pixel(c, [&](std::size_t e) {
            const vector<double> dy = load_double(out_gradient + e * lanes<T>);
            of_weight = multiply_add<double>(dy, normalised(e), of_weight);
            of_bias = of_bias + dy;
        });
        const vector<double> weight(static_cast<double>(weights[c]));
        slope = multiply_add<double>(weight, of_weight, slope);
        level = multiply_add<double>(weight, of_bias, level);
        double* const total = totals + 2 * c * lanes<double>;
        store(total, load<double>(total) + of_weight);
        store(total + lanes<double>, load<double>(total + lanes<double>) + of_bias);
    }
    if (in_gradient == nullptr)
        return;
    const vector<double> count(static_cast<double>(groups.size()));
    level = level / count, slope = slope / count;
    for (std::size_t c = 0; c < groups.channels; ++c) {
        const vector<double> weight(static_cast<double>(weights[c]));
        groups.for_each_pixel(c, [&](std::size_t e) {
            const vector<double> dy = load_double(out_gradient + e * lanes<T>);
            store_double(in_gradient + e * lanes<T>,
                         (weight * dy - level - normalised(e) * slope) * moments.inverse_deviation);
        });
    }
}

}}} // namespace tactnet::kernels
