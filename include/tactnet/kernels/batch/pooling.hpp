#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/pooling_windows.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// Max and average pooling of one lane block. Padding is never read: a window is cut to the image. The windows
// of an average, and bins, are run-time values: the loops over them are the same for any size, and are
// compiled once.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// output = the largest value of each window; NaN wins.
template <sliding_window W, class T>
void max_pool_forward(const T* input, T* output) {
    constexpr std::size_t width = lanes<T>;
    for (std::size_t channel = 0; channel < W.input.channels; ++channel) {
        const T* from = input + channel * W.input.area() * width;
        T* to = output + channel * W.output_rows() * W.output_columns() * width;
        for_each_window<W>([&](std::size_t o, pixel_range rows, pixel_range columns) {
            vector<T> largest = load(from + (rows.begin * W.input.columns + columns.begin) * width);
            for_each_pixel<W>(rows, columns, [&](std::size_t pixel) {
                largest = maximum_keeping_nan<T>(load(from + pixel * width), largest);
            });
            store(to + o * width, largest);
        });
    }
}

/// input_gradient = the output gradient, at the first largest value of each window.
template <sliding_window W, class T>
void max_pool_backward(const T* input, const T* output, const T* output_gradient, T* input_gradient) {
    constexpr std::size_t width = lanes<T>;
    const vector<T> zero(T{});
    for (std::size_t channel = 0; channel < W.input.channels; ++channel) {
        const T* from = input + channel * W.input.area() * width;
        T* to = input_gradient + channel * W.input.area() * width;
        const std::size_t first = channel * W.output_rows() * W.output_columns();
        if constexpr (!tiles_input(W))
            std::fill_n(to, W.input.area() * width, T{});
        for_each_window<W>([&](std::size_t o, pixel_range rows, pixel_range columns) {
            const vector<T> largest = load(output + (first + o) * width);
            vector<T> rest = load(output_gradient + (first + o) * width);
            for_each_pixel<W>(rows, columns, [&](std::size_t pixel) {
                const auto here = load(from + pixel * width) == largest;
                const vector<T> given = choose<T>(here, rest, zero);
                rest = choose<T>(here, zero, rest);
                T* place = to + pixel * width;
                store(place, tiles_input(W) ? given : load(place) + given);
            });
        });
    }
}

/// output = the largest value of each bin; NaN wins.
template <class T>
void max_pool_forward(const pooling_windows& bins, std::size_t channels, const T* input, T* output) {
    constexpr std::size_t width = lanes<T>;
    const std::size_t columns_of_input = bins.columns.size;
    for (std::size_t channel = 0; channel < channels; ++channel) {
        bins.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t) {
            vector<T> largest = load(input + (rows.begin * columns_of_input + columns.begin) * width);
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x)
                    largest =
                        maximum_keeping_nan<T>(load(input + (y * columns_of_input + x) * width), largest);
            store(output + o * width, largest);
        });
        input += bins.rows.size * columns_of_input * width;
        output += bins.rows.outputs * bins.columns.outputs * width;
    }
}

/// input_gradient = the output gradient, at the first largest value of each bin; bins may overlap.
template <class T>
void max_pool_backward(const pooling_windows& bins, std::size_t channels, const T* input, const T* output,
                       const T* output_gradient, T* input_gradient) {
    constexpr std::size_t width = lanes<T>;
    const std::size_t columns_of_input = bins.columns.size, plane = bins.rows.size * columns_of_input * width,
                      outputs = bins.rows.outputs * bins.columns.outputs * width;
    const vector<T> zero(T{});
    std::fill_n(input_gradient, channels * plane, T{});
    for (std::size_t channel = 0; channel < channels; ++channel) {
        bins.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t) {
            const vector<T> largest = load(output + o * width);
            vector<T> rest = load(output_gradient + o * width);
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x) {
                    const std::size_t pixel = (y * columns_of_input + x) * width;
                    const auto here = load(input + pixel) == largest;
                    store(input_gradient + pixel, load(input_gradient + pixel) + choose<T>(here, rest, zero));
                    rest = choose<T>(here, zero, rest);
                }
        });
        input += plane, input_gradient += plane;
        output += outputs, output_gradient += outputs;
    }
}

/// output = the sum of each window ÷ its divisor.
template <class T>
void average_pool_forward(const pooling_windows& windows, std::size_t channels, const T* input, T* output) {
    constexpr std::size_t width = lanes<T>;
    const std::size_t columns_of_input = windows.columns.size;
    for (std::size_t channel = 0; channel < channels; ++channel) {
        windows.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t divisor) {
            vector<T> sum(T{});
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x)
                    sum = sum + load(input + (y * columns_of_input + x) * width);
            store(output + o * width, quotient(sum, vector<T>(static_cast<T>(divisor))));
        });
        input += windows.rows.size * windows.columns.size * width;
        output += windows.rows.outputs * windows.columns.outputs * width;
    }
}

/// input_gradient = the gradient of each window ÷ its divisor, added to all of its pixels.
template <class T>
void average_pool_backward(const pooling_windows& windows, std::size_t channels, const T* output_gradient,
                           T* input_gradient) {
    constexpr std::size_t width = lanes<T>;
    const std::size_t columns_of_input = windows.columns.size,
                      plane = windows.rows.size * windows.columns.size * width;
    std::fill_n(input_gradient, channels * plane, T{});
    for (std::size_t channel = 0; channel < channels; ++channel) {
        windows.for_each([&](std::size_t o, pixel_range rows, pixel_range columns, std::size_t divisor) {
            const vector<T> share =
                quotient(load(output_gradient + o * width), vector<T>(static_cast<T>(divisor)));
            for (std::size_t y = rows.begin; y < rows.end; ++y)
                for (std::size_t x = columns.begin; x < columns.end; ++x) {
                    T* const to = input_gradient + (y * columns_of_input + x) * width;
                    store(to, load(to) + share);
                }
        });
        input_gradient += plane;
        output_gradient += windows.rows.outputs * windows.columns.outputs * width;
    }
}

// A separable resize of one channel of a lane block, with compile-time weights. The axes `Down` and `Along`
// (image/resize_kernel.hpp, kernels/sampling_axis.hpp) have `inputs`, `outputs`, `taps` and a `table` with
// the first input and the weights of each output. A weight of zero is no tap, so that NaN and infinity reach
// only the outputs that they belong to.

/// Calls take(output pixel, values) for each output of `from`.
template <class T, class Down, class Along, class Take>
void resample_lanes(const T* from, const Take& take) {
    alignas(vector_alignment) std::array<T, Along::inputs * lanes<T>> line;
    for (std::size_t row = 0; row < Down::outputs; ++row) {
        const auto& above = Down::table[row];
        for (std::size_t column = 0; column < Along::inputs; ++column) {
            vector<T> sum(T{0});
            for (std::size_t t = 0; t < Down::taps; ++t)
                if (above.weights[t] != 0)
                    sum = multiply_add<T>(
                        vector<T>(static_cast<T>(above.weights[t])),
                        load<T>(from + ((above.first + t) * Along::inputs + column) * lanes<T>), sum);
            store(line.data() + column * lanes<T>, sum);
        }
        for (std::size_t column = 0; column < Along::outputs; ++column) {
            const auto& beside = Along::table[column];
            vector<T> sum(T{0});
            for (std::size_t t = 0; t < Along::taps; ++t)
                if (beside.weights[t] != 0)
                    sum = multiply_add<T>(vector<T>(static_cast<T>(beside.weights[t])),
                                          load<T>(line.data() + (beside.first + t) * lanes<T>), sum);
            take(row * Along::outputs + column, sum);
        }
    }
}

/// The backward pass: `to` becomes the input gradient; give(output pixel) returns the gradient of an output.
template <class T, class Down, class Along, class Give>
void resample_lanes_backward(const Give& give, T* to) {
    const auto add = [](T* place, auto weight, const vector<T>& gradient) {
        store(place, multiply_add<T>(vector<T>(static_cast<T>(weight)), gradient,
                                     load<T>(static_cast<const T*>(place))));
    };
    alignas(vector_alignment) std::array<T, Along::inputs * lanes<T>> line;
    std::fill_n(to, Down::inputs * Along::inputs * lanes<T>, T{0});
    for (std::size_t row = 0; row < Down::outputs; ++row) {
        line.fill(T{0});
        for (std::size_t column = 0; column < Along::outputs; ++column) {
            const auto& beside = Along::table[column];
            const vector<T> gradient = give(row * Along::outputs + column);
            for (std::size_t t = 0; t < Along::taps; ++t)
                if (beside.weights[t] != 0)
                    add(line.data() + (beside.first + t) * lanes<T>, beside.weights[t], gradient);
        }
        const auto& above = Down::table[row];
        for (std::size_t t = 0; t < Down::taps; ++t)
            if (above.weights[t] != 0)
                for (std::size_t column = 0; column < Along::inputs; ++column)
                    add(to + ((above.first + t) * Along::inputs + column) * lanes<T>, above.weights[t],
                        load<T>(static_cast<const T*>(line.data() + column * lanes<T>)));
    }
}

}}} // namespace tactnet::kernels
