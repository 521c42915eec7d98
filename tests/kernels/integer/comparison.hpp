#pragma once

// Methods of convolution in integers against plain loops in 64 bits.

#include <tactnet/kernels/integer/convolution/methods.hpp>
#include <tactnet/operators/activations/function.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <random>
#include <type_traits>
#include <vector>

namespace integer_test {

using namespace tactnet;
using kernels::frame_convolution;

enum class numbers_are { drawn, largest, smallest };

/// What is given to a convolution, whatever its type.
template <frame_convolution C, class Input>
struct given {
    static constexpr std::size_t filters = C.padded_filters();
    static constexpr bool words = !std::is_same_v<Input, std::uint8_t>;
    std::vector<Input> input = std::vector<Input>(C.window.input.area() * C.input_stride);
    std::vector<std::int8_t> weights = std::vector<std::int8_t>(C.filters * C.taps());
    std::vector<std::int32_t> starts = std::vector<std::int32_t>(filters),
                              added = std::vector<std::int32_t>(filters);
    std::vector<float> factors = std::vector<float>(filters);
    std::vector<std::uint8_t> other;
    int zero = 0, lowest = 0;
    Input padding{};

    explicit given(numbers_are kind) {
        std::mt19937 draw(C.filters * 131 + C.taps() + C.window.input.area());
        const auto below = [&](unsigned most) { return static_cast<int>(draw() % most); };
        const bool extreme = kind != numbers_are::drawn;
        const int largest = kind == numbers_are::smallest && words ? -32767 : words ? 32767 : 255;
        // So many products of drawn words keep within 32 bits.
        const int widest = words ? std::min(32767, static_cast<int>(2'000'000'000 / 127 / C.taps())) : 255;
        for (Input& x : input)
            x = static_cast<Input>(extreme ? std::clamp(largest, words ? -widest : 0, widest)
                                   : words ? below(static_cast<unsigned>(2 * widest + 1)) - widest
                                           : below(256));
        padding = static_cast<Input>(words           ? 0
                                     : extreme       ? 255
                                     : below(2) == 0 ? kernels::direct_integer_method<C, Input>::offset
                                                     : below(256));
        for (std::size_t i = 0; i < weights.size(); ++i)
            weights[i] = static_cast<std::int8_t>(!extreme                ? below(255) - 127
                                                  : i / C.taps() % 2 == 0 ? 127
                                                                          : -127);
        const double reach = 127.0 * widest * std::sqrt(static_cast<double>(C.taps()));
        for (std::size_t f = 0; f < C.filters; ++f) {
            starts[f] = below(200'001) - 100'000;
            added[f] = C.accumulates ? below(1000) : 0;
            factors[f] = static_cast<float>((0.2 + below(100) * 0.01) * (extreme ? 0.1 : 200) / reach);
        }
        zero = extreme ? 128 : below(256);
        lowest = C.rectifies() ? zero : 0;
        other.resize(C.output_rows() * C.output_columns() * C.output_stride());
        for (std::uint8_t& o : other)
            o = static_cast<std::uint8_t>(below(256));
    }
    [[nodiscard]] kernels::byte_range range() const { return {lowest, 255, zero}; }
    [[nodiscard]] std::int8_t weight(std::size_t f, std::size_t c, std::size_t r, std::size_t k) const {
        return weights[f * C.taps() + (c * C.window.kernel.rows + r) * C.window.kernel.columns + k];
    }
    /// A sum, or the largest under a pool.
    [[nodiscard]] std::int64_t sum(std::size_t y, std::size_t x, std::size_t f) const {
        const sliding_window& w = C.window;
        std::int64_t best = INT64_MIN;
        for (std::size_t i = y * C.pool.rows; i < std::min((y + 1) * C.pool.rows, C.rows()); ++i)
            for (std::size_t j = x * C.pool.columns; j < std::min((x + 1) * C.pool.columns, C.columns());
                 ++j) {
                std::int64_t s = starts[f];
                if (C.accumulates)
                    s += std::int64_t{added[f]} *
                         other[(i * C.output_columns() + j) * C.output_stride() + C.map_offset + f];
                const std::size_t channels = w.input.channels / C.groups,
                                  first = f / (C.filters / C.groups) * channels;
                for (std::size_t c = 0; c < channels; ++c)
                    for (std::size_t r = 0; r < w.kernel.rows; ++r)
                        for (std::size_t k = 0; k < w.kernel.columns; ++k) {
                            const std::size_t row = i * w.stride.rows + r, column = j * w.stride.columns + k;
                            const bool inside = row >= w.top && row - w.top < w.input.rows &&
                                                column >= w.left && column - w.left < w.input.columns;
                            s += std::int64_t{weight(f, c, r, k)} *
                                 (inside ? input[((row - w.top) * w.input.columns + column - w.left) *
                                                     C.input_stride +
                                                 first + c]
                                         : padding);
                        }
                best = std::max(best, s);
            }
        return best;
    }
};

/// Counts the outputs of `run(to)` that differ from plain loops; `saturated` counts those at an end of the
/// range.
template <frame_convolution C, class Input, class Output, class Run>
std::size_t outputs_differing(const given<C, Input>& numbers, const Run& run, std::size_t* saturated) {
    constexpr std::size_t pixels = C.output_rows() * C.output_columns(), stride = C.output_stride();
    std::vector<Output> map(pixels * stride + 64, Output{77});
    if (C.accumulates)
        std::copy(numbers.other.begin(), numbers.other.end(), map.begin());
    run(map.data() + C.map_offset);

    std::size_t wrong = 0;
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
        for (std::size_t f = 0; f < C.filters; ++f) {
            const float product =
                static_cast<float>(numbers.sum(pixel / C.output_columns(), pixel % C.output_columns(), f)) *
                numbers.factors[f];
            const Output found = map[pixel * stride + C.map_offset + f];
            if constexpr (std::is_same_v<Output, float>) {
                const float expected = C.rectifies() && product < 0 ? 0.0f : product;
                wrong += std::memcmp(&found, &expected, sizeof(float)) != 0;
            } else {
                const double nearest = std::nearbyint(static_cast<double>(product));
                wrong += found != std::clamp<double>(nearest + numbers.zero, numbers.lowest, 255);
                if (saturated != nullptr)
                    *saturated += found == 0 || found == 255;
            }
        }
        // Channels of others in a wider map.
        for (std::size_t c = 0; C.map_stride > 0 && c < stride; ++c)
            wrong +=
                (c < C.map_offset || c >= C.map_offset + C.filters) && map[pixel * stride + c] != Output{77};
    }
    for (std::size_t i = pixels * stride; i < map.size(); ++i)
        wrong += map[i] != Output{77};
    return wrong;
}
template <class Numbers>
const std::int8_t* as_bytes(const Numbers& numbers) {
    return reinterpret_cast<const std::int8_t*>(numbers.data());
}
template <class Numbers>
std::size_t guard_touched(const Numbers& numbers, std::size_t used, typename Numbers::value_type guard) {
    return static_cast<std::size_t>(std::count_if(numbers.begin() + static_cast<std::ptrdiff_t>(used),
                                                  numbers.end(), [&](auto n) { return n != guard; }));
}

/// Counts the outputs of a method that differ, and the bytes that it writes outside its memory. The workspace
/// holds garbage before, so that what is read before it is written shows.
template <class Method, frame_convolution C, class Input, class Output = std::uint8_t>
std::size_t differing(numbers_are kind = numbers_are::drawn, std::size_t* saturated = nullptr) {
    constexpr std::size_t guard = 64;
    const given<C, Input> numbers(kind);
    aligned_vector<std::int8_t> packed(Method::packed_elements + guard, std::int8_t{99});
    Method::pack([&](auto... place) { return numbers.weight(place...); }, packed.data());
    std::size_t wrong = guard_touched(packed, Method::packed_elements, 99);

    std::vector<std::int32_t> starts(Method::filter_places), added(Method::filter_places);
    std::vector<float> factors(Method::filter_places);
    for (std::size_t f = 0; f < C.filters; ++f) {
        const std::size_t place = Method::place(f);
        starts[place] = numbers.starts[f], added[place] = numbers.added[f];
        factors[place] = numbers.factors[f];
        for (std::size_t i = 0; i < C.taps(); ++i)
            starts[place] += Method::offset * numbers.weights[f * C.taps() + i];
    }
    aligned_vector<std::uint8_t> workspace(Method::workspace_elements + guard, std::uint8_t{0x5a});
    wrong += outputs_differing<C, Input, Output>(
        numbers,
        [&](Output* to) {
            Method::run(packed.data(),
                        {as_bytes(starts), as_bytes(factors), as_bytes(added), numbers.range(),
                         static_cast<std::uint8_t>(numbers.padding)},
                        numbers.input.data(), to, workspace.data());
        },
        saturated);
    return wrong + guard_touched(workspace, Method::workspace_elements, 0x5a);
}

/// Of several convolutions by taps.
template <class Input, frame_convolution... C>
std::size_t direct_differing(numbers_are kind = numbers_are::drawn) {
    return (differing<kernels::direct_integer_method<C, Input>, C, Input>(kind) + ...);
}

/// A convolution by its window; pixels lie side by side, or with lanes between them.
constexpr frame_convolution of(shape input, std::size_t filters, extent2d kernel, extent2d stride = 1,
                               padding around = padding::same, std::size_t input_stride = 0) {
    return {.window = sliding_window::over(input, kernel, stride, around),
            .filters = filters,
            .input_stride = input_stride > 0 ? input_stride : input.channels};
}
/// With a max pool and a ReLU after it.
constexpr frame_convolution pooled(frame_convolution c, extent2d pool, std::size_t rows, std::size_t columns,
                                   bool relu = true) {
    c.pool = pool, c.pooled_rows = rows, c.pooled_columns = columns;
    c.activation = relu ? fused<relu_function> : &kernels::no_activation;
    return c;
}
constexpr frame_convolution adding(frame_convolution c, bool relu = false) {
    c.accumulates = true, c.activation = relu ? fused<relu_function> : &kernels::no_activation;
    return c;
}
constexpr frame_convolution grouped(frame_convolution c, std::size_t groups) {
    c.groups = groups;
    return c;
}
/// One filter per channel.
constexpr frame_convolution depthwise(frame_convolution c) {
    return grouped(c, c.filters);
}
constexpr frame_convolution among(frame_convolution c, std::size_t stride, std::size_t offset) {
    c.map_stride = stride, c.map_offset = offset;
    return c;
}

} // namespace integer_test
