#pragma once

// What a network in 8 bits must give, from its folded numbers by the rules that are written in the headers of
// deployment/eight_bit: the reference in whole numbers of 64 bits, with the windows of the one in double
// (reference.hpp). Of the library it uses the types of the steps, for their sizes, and none of its kernels
// nor of its packing.

#include <tactnet/deployment/deployed_view.hpp>
#include <tactnet/deployment/eight_bit/steps.hpp>
#include <tactnet/operators/residual/step.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <support/layers/window_of.hpp>
#include <type_traits>
#include <vector>

namespace support {

/// A map of whole numbers, or, behind the last step, of floats.
struct whole_map {
    std::size_t rows = 0, columns = 0, channels = 0;
    std::vector<std::int64_t> whole;
    std::vector<float> floats;

    whole_map() = default;
    whole_map(tactnet::shape s)
        : rows(s.rows),
          columns(s.columns),
          channels(s.channels),
          whole(s.rows * s.columns * s.channels),
          floats(whole.size()) {}
    [[nodiscard]] std::size_t at(std::size_t y, std::size_t x, std::size_t c) const {
        return (y * columns + x) * channels + c;
    }
    /// With `value` in the padding of a window.
    [[nodiscard]] whole_map padded(const reference_window& w, std::int64_t value) const {
        whole_map all(tactnet::shape{rows + w.top + w.bottom, columns + w.left + w.right, channels});
        std::fill(all.whole.begin(), all.whole.end(), value);
        for (std::size_t y = 0; y < rows; ++y)
            std::copy_n(whole.data() + at(y, 0, 0), columns * channels,
                        all.whole.data() + all.at(y + w.top, w.left, 0));
        return all;
    }
};

/// What the bytes of a map stand for: (byte − zero) × scale.
struct reference_range {
    double scale = 1;
    std::int64_t zero = 0;

    static reference_range next(const float*& from) {
        const reference_range r{static_cast<double>(from[0]), static_cast<std::int64_t>(from[1])};
        from += 2;
        return r;
    }
};

/// Number by number: f(number, channel).
template <class Function>
whole_map each_number(whole_map map, const Function& f) {
    for (std::size_t i = 0; i < map.whole.size(); ++i)
        map.whole[i] = f(map.whole[i], i % map.channels);
    return map;
}
/// A layer of the reference in double, of what bytes stand for, times a whole number that makes the results
/// whole: they then pass exactly.
inline whole_map exact_layer(const reference_pointer& layer, const whole_map& in, std::int64_t zero = 0,
                             double times = 1) {
    sample map(in.whole.size());
    for (std::size_t i = 0; i < map.size(); ++i)
        map[i % in.channels * (in.rows * in.columns) + i / in.channels].value =
            static_cast<double>(in.whole[i] - zero);
    map = layer->forward({}, {map}).front();
    const extents3 to = layer->output;
    whole_map result(tactnet::shape{to.rows, to.columns, to.channels});
    for (std::size_t i = 0; i < map.size(); ++i)
        result.whole[i] = static_cast<std::int64_t>(
            std::nearbyint(map[i % to.channels * to.area() + i / to.channels].value * times));
    return result;
}

/// sum × factor in single precision, to the nearest whole number, ties to the even one, plus the zero,
/// within the range.
inline std::int64_t reference_byte(std::int64_t sum, float factor, std::int64_t zero, bool relu) {
    const float product = static_cast<float>(sum) * factor;
    const double byte = std::nearbyint(static_cast<double>(product)) + static_cast<double>(zero);
    return static_cast<std::int64_t>(std::clamp(byte, relu ? static_cast<double>(zero) : 0.0, 255.0));
}

/// A filter in whole numbers: weights of at most 127 steps, and what a step of the sum stands for.
struct reference_filter {
    std::vector<std::int64_t> weights;
    double unit;
    std::int64_t bias, added = 0; ///< units, and how many of them a step of the other map is

    reference_filter(const float* from, std::size_t count, double of_bias, double step,
                     const reference_range& input, const reference_range* other, std::int64_t largest_input)
        : unit(step * input.scale) {
        if (other != nullptr) {
            added = static_cast<std::int64_t>(std::nearbyint(other->scale / unit));
            if (added < 1 || added > 1'000'000)
                throw std::logic_error("the reference: a byte that is added is no number of units");
        }
        std::int64_t most = 0, largest = 0;
        for (std::size_t i = 0; i < count; ++i) {
            weights.push_back(static_cast<std::int64_t>(std::nearbyint(static_cast<double>(from[i]) / step)));
            most += std::abs(weights.back()) * largest_input;
            largest = std::max(largest, std::abs(weights.back()));
        }
        if (largest > 127)
            throw std::logic_error("the reference: a weight of more than 127 steps");
        bias = static_cast<std::int64_t>(std::nearbyint(of_bias / unit));
        if (most + std::abs(bias) + 255 * added > std::int64_t{2'000'000'000})
            throw std::logic_error("the reference: a sum that may need more than 32 bits");
    }
};

/// A step: `run(folded, input, what lies in the output)`.
template <class Step>
struct reference_step;

/// Convolution, the sum with what lies in the output, max pool, ReLU, rounding.
template <tactnet::kernels::frame_convolution C, bool ReadsWords, bool WritesBytes>
whole_map reference_convolution(const float* folded, const whole_map& in, const whole_map& other) {
    const tactnet::sliding_window& w = C.window;
    const std::size_t in_group = w.input.channels / C.groups,
                      of_one = in_group * w.kernel.rows * w.kernel.columns;
    const float* const biases = folded + C.filters * of_one;
    const float* const steps = biases + C.filters;
    const float* at = steps + C.filters;
    const reference_range input = reference_range::next(at);
    const reference_range added = C.accumulates ? reference_range::next(at) : reference_range{};
    const reference_range output = WritesBytes ? reference_range::next(at) : reference_range{};

    // Padding holds the zero of the map.
    reference_window window = window_of(w);
    const whole_map all = in.padded(window, input.zero);
    window.input = {in_group, all.rows, all.columns};
    window.top = window.bottom = window.left = window.right = 0;
    const std::size_t pooled_rows = C.pooled_rows > 0 ? C.pooled_rows : w.output_rows(),
                      pooled_columns = C.pooled_columns > 0 ? C.pooled_columns : w.output_columns(),
                      taps = w.kernel.rows * w.kernel.columns, area = w.output_rows() * w.output_columns();
    const reference_window pool =
        pool_window({1, w.output_rows(), w.output_columns()}, C.pool, pooled_rows, pooled_columns);
    whole_map result(tactnet::shape{pooled_rows, pooled_columns, C.filters});
    for (std::size_t f = 0; f < C.filters; ++f) {
        const reference_filter filter(folded + f * of_one, of_one, static_cast<double>(biases[f]),
                                      static_cast<double>(steps[f]), input, C.accumulates ? &added : nullptr,
                                      ReadsWords ? 32768 : 255);
        const std::size_t first = f / (C.filters / C.groups) * in_group;
        std::vector<std::int64_t> sums(area, filter.bias);
        for (std::size_t c = 0; c < in_group; ++c)
            window.for_each_tap([&](std::size_t to, std::size_t from, std::size_t place) {
                const std::size_t tap = c * taps + place;
                const std::int64_t value = all.whole[from * all.channels + first + c];
                sums[to] += filter.weights[tap] * (value - input.zero);
            });
        for (std::size_t o = 0; C.accumulates && o < area; ++o)
            sums[o] += filter.added * (other.whole[o * other.channels + f] - added.zero);
        std::vector<std::int64_t> largest(pooled_rows * pooled_columns,
                                          std::numeric_limits<std::int64_t>::min());
        pool.for_each_tap([&](std::size_t to, std::size_t from, std::size_t) {
            largest[to] = std::max(largest[to], sums[from]);
        });
        const auto factor = static_cast<float>(WritesBytes ? filter.unit / output.scale : filter.unit);
        for (std::size_t o = 0; o < largest.size(); ++o)
            if (WritesBytes)
                result.whole[o * C.filters + f] =
                    reference_byte(largest[o], factor, output.zero, C.rectifies());
            else
                result.floats[o * C.filters + f] =
                    static_cast<float>(C.rectifies() ? std::max<std::int64_t>(largest[o], 0) : largest[o]) *
                    factor;
    }
    return result;
}
template <class Input, class Output, tactnet::kernels::frame_convolution Kernel>
struct reference_step<tactnet::convolution_step<tactnet::eight_bit_between<Input, Output>, Kernel>> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map& other) {
        return reference_convolution<Kernel, (sizeof(Input) > 1), (sizeof(Output) == 1)>(folded, in, other);
    }
};
template <class Input, class Output, tactnet::kernels::frame_dense Kernel>
struct reference_step<tactnet::dense_step<tactnet::eight_bit_between<Input, Output>, Kernel>> {
    static constexpr tactnet::kernels::frame_convolution whole{
        .window = {Kernel.input, {Kernel.input.rows, Kernel.input.columns}, 1},
        .filters = Kernel.outputs,
        .input_stride = 1};
    static whole_map run(const float* folded, const whole_map& in, const whole_map& other) {
        return reference_convolution<whole, (sizeof(Input) > 1), (sizeof(Output) == 1)>(folded, in, other);
    }
};

template <class Input, tactnet::shape Map, std::size_t Stride, bool Rectified>
struct reference_step<
    tactnet::norm_step<tactnet::eight_bit_between<Input, std::uint8_t>, Map, Stride, Rectified>> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        const float* at = folded + 2 * Map.channels;
        const reference_range input = reference_range::next(at), output = reference_range::next(at);
        return each_number(in, [&](std::int64_t number, std::size_t c) {
            const auto weight = static_cast<double>(folded[c]),
                       offset = static_cast<double>(folded[Map.channels + c]);
            const double unit =
                std::max(std::abs(weight) / 32767 * input.scale, std::abs(offset) / std::pow(2.0, 29));
            const auto times = static_cast<std::int64_t>(std::nearbyint(weight * input.scale / unit));
            const std::int64_t sum =
                static_cast<std::int64_t>(std::nearbyint(offset / unit)) + times * (number - input.zero);
            return reference_byte(sum, static_cast<float>(unit / output.scale), output.zero, Rectified);
        });
    }
};

template <class Input, tactnet::shape Map, std::size_t Stride, class Offset>
struct reference_step<
    tactnet::square_root_step<tactnet::eight_bit_between<Input, std::uint8_t>, Map, Stride, Offset>> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        const reference_range input = reference_range::next(folded), output = reference_range::next(folded);
        const auto offset = static_cast<float>(static_cast<double>(Offset::num) /
                                               static_cast<double>(Offset::den) / input.scale);
        const auto root = [&](std::int64_t steps) { // in parts of 1/1024
            const float sum = static_cast<float>(std::max<std::int64_t>(steps, 0)) + offset;
            return static_cast<std::int64_t>(std::nearbyint(static_cast<double>(std::sqrt(sum)) * 1024));
        };
        const float part = static_cast<float>(1 / 1024.0 / output.scale),
                    factor = std::sqrt(static_cast<float>(input.scale)) * part;
        return each_number(in, [&](std::int64_t number, std::size_t) {
            return reference_byte(root(number - input.zero) - root(0), factor, output.zero, true);
        });
    }
};

template <class Function, tactnet::shape Map, std::size_t Stride>
struct reference_step<tactnet::activation_step<tactnet::eight_bit, Function, Map, Stride>> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        const reference_range input = reference_range::next(folded);
        if constexpr (std::is_same_v<Function, tactnet::relu_function>) {
            return each_number(in, [&](std::int64_t n, std::size_t) { return std::max(n, input.zero); });
        } else {
            const reference_range output = reference_range::next(folded);
            return each_number(in, [&](std::int64_t number, std::size_t) {
                const double value = Function::value(static_cast<double>(number - input.zero) * input.scale);
                return std::clamp<std::int64_t>(
                    static_cast<std::int64_t>(std::nearbyint(value / output.scale)) + output.zero, 0, 255);
            });
        }
    }
};

/// The factor of a slope is rounded once, as that of the ranges.
template <tactnet::shape Map, std::size_t Stride>
struct reference_step<tactnet::parametric_relu_step<tactnet::eight_bit, Map, Stride>> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        const float* at = folded + Map.channels;
        const reference_range input = reference_range::next(at), output = reference_range::next(at);
        return each_number(in, [&](std::int64_t number, std::size_t c) {
            const std::int64_t steps = number - input.zero;
            const double slope = steps > 0 ? 1 : static_cast<double>(folded[c]);
            return reference_byte(steps, static_cast<float>(slope * (input.scale / output.scale)),
                                  output.zero, false);
        });
    }
};

/// In double precision, rounded once.
template <class Step>
struct reference_step<tactnet::step_with_softmax<Step>> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map& other) {
        whole_map map = reference_step<Step>::run(folded, in, other);
        const reference_pointer softmax = reference_softmax({map.channels, 1, 1});
        for (std::size_t pixel = 0; pixel < map.floats.size(); pixel += map.channels) {
            sample values(map.channels);
            for (std::size_t c = 0; c < map.channels; ++c)
                values[c].value = static_cast<double>(map.floats[pixel + c]);
            values = softmax->forward({}, {values}).front();
            for (std::size_t c = 0; c < map.channels; ++c)
                map.floats[pixel + c] = static_cast<float>(values[c].value);
        }
        return map;
    }
};

template <tactnet::sliding_window W, std::size_t Stride>
struct reference_step<tactnet::pool_step<tactnet::eight_bit, W, Stride>> {
    static whole_map run(const float*, const whole_map& in, const whole_map&) {
        return exact_layer(reference_max_pool(window_of(W)), in);
    }
};

template <class Output, tactnet::pooling_windows W, std::size_t Channels, std::size_t Stride>
struct reference_step<
    tactnet::average_pool_step<tactnet::eight_bit_between<std::uint8_t, Output>, W, Channels, Stride>> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        constexpr bool writes_bytes = sizeof(Output) == 1;
        const reference_range input = reference_range::next(folded);
        const reference_range output = writes_bytes ? reference_range::next(folded) : reference_range{};
        whole_map result(tactnet::shape{W.rows.outputs, W.columns.outputs, Channels});
        for (std::size_t y = 0; y < result.rows; ++y)
            for (std::size_t x = 0; x < result.columns; ++x)
                for (std::size_t c = 0; c < Channels; ++c) {
                    const auto rows = W.rows.pixels(y), columns = W.columns.pixels(x);
                    std::int64_t sum = 0;
                    for (std::size_t r = rows.begin; r < rows.end; ++r)
                        for (std::size_t k = columns.begin; k < columns.end; ++k)
                            sum += in.whole[in.at(r, k, c)] - input.zero;
                    const float factor =
                        static_cast<float>(input.scale / output.scale) / static_cast<float>(W.divisor(y, x));
                    const std::size_t o = result.at(y, x, c);
                    if (writes_bytes)
                        result.whole[o] = reference_byte(sum, factor, output.zero, false);
                    else
                        result.floats[o] = static_cast<float>(sum) * factor;
                }
        return result;
    }
};

template <class... Steps>
struct reference_step<tactnet::step_chain<Steps...>> {
    static whole_map run(const float* folded, whole_map map, const whole_map& other) {
        ((map = reference_step<Steps>::run(folded, map, other), folded += Steps::folded_elements), ...);
        return map;
    }
};

template <class Main, class Skip, std::size_t Stride>
struct reference_step<tactnet::residual_step<Main, Skip, Stride>> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        if constexpr (std::is_same_v<Skip, tactnet::no_step>)
            return reference_step<Main>::run(folded, in, in);
        else
            return reference_step<Main>::run(
                folded, in, reference_step<Skip>::run(folded + Main::folded_elements, in, whole_map{}));
    }
};

template <>
struct reference_step<tactnet::no_step> {
    static whole_map run(const float*, whole_map map, const whole_map&) { return map; }
};

/// The product of a byte and the byte of its channel's factor.
template <class Branch, tactnet::shape Map, std::size_t Stride>
struct reference_step<tactnet::gate_step<Branch, tactnet::product_step<tactnet::eight_bit, Map, Stride>>> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        const whole_map factors = reference_step<Branch>::run(folded, in, whole_map{});
        folded += Branch::folded_elements;
        const reference_range input = reference_range::next(folded), other = reference_range::next(folded),
                              output = reference_range::next(folded);
        const auto scale = static_cast<float>(input.scale * other.scale / output.scale);
        return each_number(in, [&](std::int64_t number, std::size_t c) {
            return reference_byte((number - input.zero) * (factors.whole[c] - other.zero), scale, output.zero,
                                  false);
        });
    }
};

template <class Format, tactnet::shape Input, std::size_t InputStride, std::size_t Stride, class... Branches>
struct reference_step<tactnet::concatenation_step<Format, Input, InputStride, Stride, Branches...>> {
    static whole_map run(const float* folded, const whole_map& in, const whole_map&) {
        std::vector<whole_map> parts;
        ((parts.push_back(reference_step<typename Branches::step>::run(folded, in, whole_map{})),
          folded += Branches::step::folded_elements),
         ...);
        std::size_t channels = 0;
        for (const whole_map& part : parts)
            channels += part.channels;
        whole_map result(tactnet::shape{parts[0].rows, parts[0].columns, channels});
        std::size_t first = 0;
        for (const whole_map& part : parts) {
            for (std::size_t i = 0; i < part.whole.size(); ++i)
                result.whole[i / part.channels * channels + first + i % part.channels] = part.whole[i];
            first += part.channels;
        }
        return result;
    }
};

/// Counts [channel][row][column] in words: counts × steps − mean × steps, both rounded.
template <tactnet::shape Input, class Count>
whole_map reference_entrance(const float* folded, std::span<const Count> counts) {
    const auto steps = static_cast<double>(folded[Input.size()]);
    whole_map map(Input);
    for (std::size_t e = 0; e < Input.size(); ++e)
        map.whole[e % Input.area() * Input.channels + e / Input.area()] =
            static_cast<std::int64_t>(std::nearbyint(static_cast<double>(counts[e]) * steps) -
                                      std::nearbyint(static_cast<double>(folded[e]) * steps));
    return map;
}

/// The outputs [channel][row][column] of a frame.
template <class View, class Count>
std::vector<float> reference_outputs(std::span<const float> folded, std::span<const Count> counts) {
    const whole_map out = reference_step<typename View::steps>::run(
        folded.data() + View::steps_folded, reference_entrance<View::input_shape>(folded.data(), counts),
        whole_map{});
    std::vector<float> result;
    for (std::size_t c = 0; c < out.channels; ++c)
        for (std::size_t pixel = 0; pixel < out.rows * out.columns; ++pixel)
            result.push_back(out.floats[pixel * out.channels + c]);
    return result;
}

} // namespace support

#include <support/layers/whole_reference_maps.hpp>
#include <support/layers/whole_reference_norms.hpp>
