#pragma once

#include <tactnet/kernels/batch/pooling.hpp>
#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/kernels/norms.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <cstddef>

// Batch norm of one channel of a lane block once its moments are known, alone or fused with ReLU and max
// pooling. The fused map between norm and pool is never stored: the backward pass needs only the element that
// each window selected. A norm keeps the order of elements or reverses it, so the selection is known before
// the moments are.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// y = (x − center) × scale + shift
template <class T>
struct normalising {
    T center, scale, shift;

    [[nodiscard]] vector<T> operator()(const vector<T>& x) const {
        return multiply_add<T>(x - vector<T>(center), vector<T>(scale), vector<T>(shift));
    }
};

/// dx = ((x − center) × slope + dy − level) × scale
template <class T>
struct normalising_gradient {
    T center, slope, level, scale;

    [[nodiscard]] vector<T> operator()(const vector<T>& x, const vector<T>& dy) const {
        return multiply_add<T>(x - vector<T>(center), vector<T>(slope), dy - vector<T>(level)) *
               vector<T>(scale);
    }
};

/// Normalises `count` values, a multiple of the lanes. The output may be the input's memory.
template <class T>
void normalise(const normalising<T>& rule, const T* input, T* output, std::size_t count) {
    for (std::size_t i = 0; i < count; i += lanes<T>)
        store(output + i, rule(load(input + i)));
}

/// The backward pass. Lanes whose `use` is zero get zeros.
template <class T>
void normalise_backward(const normalising_gradient<T>& rule, const vector<T>& use, const T* input,
                        const T* output_gradient, T* input_gradient, std::size_t count) {
    for (std::size_t i = 0; i < count; i += lanes<T>)
        store(input_gradient + i, rule(load(input + i), load(output_gradient + i)) * use);
}

/// chosen = the element of each window that is the largest after the norm: the largest for a rising norm, the
/// smallest for a falling one (sign −1), the first for a constant one (sign 0). Of equal elements the first
/// is chosen; NaN wins.
template <sliding_window W, class T>
void choose_for_pool(T sign, const T* input, T* chosen) {
    constexpr std::size_t width = lanes<T>;
    const vector<T> direction(sign);
    for_each_window<W>([&](std::size_t o, pixel_range rows, pixel_range columns) {
        vector<T> best = load(input + (rows.begin * W.input.columns + columns.begin) * width);
        vector<T> largest = direction * best;
        for_each_pixel<W>(rows, columns, [&](std::size_t pixel) {
            const vector<T> x = load(input + pixel * width), y = direction * x;
            const auto larger = (y > largest) || !(y == y); // a NaN stays
            largest = choose<T>(larger, y, largest);
            best = choose<T>(larger, x, best);
        });
        store(chosen + o * width, best);
    });
}

/// output = max(0, rule(x)) for `count` values, a multiple of the lanes.
template <class T>
void normalise_and_rectify(const normalising<T>& rule, const T* input, T* output, std::size_t count) {
    const vector<T> zero(T{});
    for (std::size_t i = 0; i < count; i += lanes<T>) {
        const vector<T> y = rule(load(input + i));
        store(output + i, choose<T>(y < zero, zero, y));
    }
}

/// output = max(0, the largest of rule(x) over each window).
template <sliding_window W, class T>
void normalised_pool_forward(const normalising<T>& rule, const T* input, T* output) {
    constexpr std::size_t width = lanes<T>;
    const vector<T> zero(T{});
    for_each_window<W>([&](std::size_t o, pixel_range rows, pixel_range columns) {
        vector<T> largest = rule(load(input + (rows.begin * W.input.columns + columns.begin) * width));
        for_each_pixel<W>(rows, columns, [&](std::size_t pixel) {
            largest = maximum_keeping_nan<T>(rule(load(input + pixel * width)), largest);
        });
        store(output + o * width, choose<T>(largest < zero, zero, largest));
    });
}

/// The input gradient. The gradient of a positive output goes to the first element of its window that equals
/// the chosen one, then through the norm. Lanes whose `use` is zero get zeros.
template <sliding_window W, class T>
void normalised_pool_backward(const normalising_gradient<T>& rule, const vector<T>& use, const T* input,
                              const T* output, const T* chosen, const T* output_gradient, T* input_gradient) {
    constexpr std::size_t width = lanes<T>;
    const vector<T> zero(T{});
    if constexpr (!tiles_input(W))
        std::fill_n(input_gradient, W.input.area() * width, T{});
    for_each_window<W>([&](std::size_t o, pixel_range rows, pixel_range columns) {
        const vector<T> best = load(chosen + o * width);
        vector<T> rest = choose<T>(load(output + o * width) > zero, load(output_gradient + o * width), zero);
        for_each_pixel<W>(rows, columns, [&](std::size_t pixel) {
            const vector<T> x = load(input + pixel * width);
            const auto here = x == best;
            const vector<T> dy = choose<T>(here, rest, zero);
            rest = choose<T>(here, zero, rest);
            T* to = input_gradient + pixel * width;
            if constexpr (tiles_input(W))
                store(to, rule(x, dy) * use);
            else
                store(to, load(to) + dy);
        });
    });
    if constexpr (!tiles_input(W))
        normalise_backward(rule, use, input, input_gradient, input_gradient, W.input.area() * width);
}

// Group, instance and layer norms of a lane block. Each sample has moments of its own: lanes never mix.
// Everything is computed in double and rounded once, so that neither a mean far from zero nor a large or tiny
// deviation costs accuracy. `lanes<double>` samples at a time; pointers to elements point to the first of
// them.

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
