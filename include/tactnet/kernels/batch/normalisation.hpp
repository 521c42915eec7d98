#pragma once

#include <tactnet/kernels/batch/pooling.hpp>
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

}}} // namespace tactnet::kernels
