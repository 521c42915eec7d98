#pragma once

#include <tactnet/kernels/batch/normalisation.hpp>
#include <tactnet/kernels/batch/pooling.hpp>

#include <algorithm>
#include <cstddef>

// Batch norm, ReLU and max pooling of one channel of one group. The map between them is never stored: what
// the way back must know of it is which element each window chose. A norm keeps the order of elements, or
// turns it round, so that this is known before its moments are.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace kernels {

/// chosen = the largest of each window by a rising norm, the smallest by a falling one (sign −1), the first
/// by one that is the same everywhere (sign 0); of equal elements the first, and a NaN where there is one.
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

/// output = max(0, rule(x)) over `count` values, a multiple of the lanes.
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

/// The input's gradient: what reaches the ReLU's outputs above zero goes to the first element of each window
/// that is the chosen one, and all of it through the norm. Lanes with a zero in `use` get a zero.
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

} // namespace kernels
} // namespace TACTNET_ARCH
} // namespace tactnet
