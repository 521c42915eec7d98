#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/simd/vector.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

// A separable resize of one channel of a lane block, with compile-time weights. The axes `Down` and `Along`
// (image/resize_kernel.hpp, kernels/sampling_axis.hpp) have `inputs`, `outputs`, `taps` and a `table` with
// the first input and the weights of each output. A weight of zero is no tap, so that NaN and infinity reach
// only the outputs that they belong to.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

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
