#pragma once

#include <tactnet/detail/indices.hpp>
#include <tactnet/kernels/batch/direct_convolution.hpp>
#include <tactnet/kernels/batch/direct_gradient.hpp>
#include <tactnet/kernels/method_list.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <type_traits>

// Depthwise convolution of one lane block: each channel has one filter. A row of a channel is read once for
// all kernel columns, and the gradient of all taps is accumulated at once. The sums run in the same order as
// those of direct convolution of one channel, so that both give the same bits.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// Neighbouring outputs of one channel, from `Outputs` accumulators and the inputs that they share.
template <batch_convolution C, std::size_t Outputs, class T>
[[gnu::always_inline]] inline void convolve_depthwise_block(const T* input, const T* weights, T start,
                                                            T* output, std::size_t first_row,
                                                            std::size_t last_row) {
    constexpr std::size_t width = lanes<T>, taps = C.kernel.columns, step = C.stride.columns,
                          reads = (Outputs - 1) * step + taps;
    std::array<vector<T>, Outputs> sums;
    sums.fill(vector<T>(start));
    for (std::size_t row = first_row; row < last_row; ++row) {
        std::array<vector<T>, reads> x;
#pragma GCC unroll 64
        for (std::size_t i = 0; i < reads; ++i)
            x[i] = load(input + static_cast<std::ptrdiff_t>((row * C.input.columns + i) * width));
#pragma GCC unroll 64
        for (std::size_t tap = 0; tap < taps; ++tap) {
            const vector<T> weight(weights[row * taps + tap]);
#pragma GCC unroll 64
            for (std::size_t o = 0; o < Outputs; ++o)
                sums[o] = multiply_add(weight, x[o * step + tap], sums[o]);
        }
    }
#pragma GCC unroll 64
    for (std::size_t o = 0; o < Outputs; ++o)
        store(output + o * width, sums[o]);
}

/// Depthwise convolution.
template <batch_convolution C, class T>
struct depthwise_lane_method {
    static constexpr const char* name = "depthwise";
    static constexpr bool applicable = C.one_filter_per_channel() && C.spacing == extent2d(1);
    static constexpr std::size_t half_products = direct_cost(C);
    static constexpr std::size_t packed_elements = C.weights();
    static constexpr std::size_t workspace_elements = 0;

    template <class Weight>
    static void pack(const Weight& weight, T* to) {
        pack_taps(weight, C.output.channels, C.output.channels, 1, 1, C.kernel, to);
    }
    [[gnu::flatten]] static void run(const T* packed, const T* bias, const T* input, T* output, T*) {
        constexpr std::size_t width = lanes<T>;
        constexpr tap_axis rows = C.row_axis(), columns = C.column_axis();
        constexpr std::size_t begin = columns.interior_begin(), end = columns.interior_end();
        for (std::size_t channel = 0; channel < C.output.channels; ++channel) {
            const T start = bias ? bias[channel] : T{};
            for (std::size_t y = 0; y < C.output.rows; ++y) {
                const std::size_t first = rows.first_tap(y), last = rows.last_tap(y);
                // Of tap (0, 0); it may be on padding.
                const std::ptrdiff_t corner =
                    rows.position(y) * static_cast<std::ptrdiff_t>(C.input.columns) + columns.position(0);
                const T* const from = input + corner * static_cast<std::ptrdiff_t>(width);
                T* const to = output + y * C.output.columns * width;
                const auto edge = [&](std::size_t x) {
                    vector<T> sum(start);
                    for (std::size_t row = first; row < last; ++row)
                        for (std::size_t tap = columns.first_tap(x); tap < columns.last_tap(x); ++tap)
                            sum = multiply_add(
                                vector<T>(packed[row * C.kernel.columns + tap]),
                                load(from +
                                     static_cast<std::ptrdiff_t>(
                                         (row * C.input.columns + x * C.stride.columns + tap) * width)),
                                sum);
                    store(to + x * width, sum);
                };
                for (std::size_t x = 0; x < begin; ++x)
                    edge(x);
                blocked<end - begin, block>([&](auto outputs, std::size_t x) {
                    convolve_depthwise_block<C, outputs>(
                        from + static_cast<std::ptrdiff_t>((begin + x) * C.stride.columns * width), packed,
                        start, to + (begin + x) * width, first, last);
                });
                for (std::size_t x = end; x < C.output.columns; ++x)
                    edge(x);
            }
            packed += C.kernel.area();
            input += C.input.area() * width;
            output += C.output.area() * width;
        }
    }

private:
    /// Outputs of a register block: accumulators, the inputs of one row and a weight fit into the registers.
    static constexpr std::size_t block = [] {
        std::size_t outputs = 8;
        while (outputs > 1 &&
               outputs + (outputs - 1) * C.stride.columns + C.kernel.columns + 1 > vector_registers)
            --outputs;
        return outputs;
    }();
};

/// The weight gradient of a depthwise convolution. All taps of `block_rows` kernel rows stay in registers.
template <batch_convolution C, class T>
struct depthwise_gradient {
    static constexpr const char* name = "depthwise";
    static constexpr bool applicable = C.one_filter_per_channel() && C.kernel.columns <= max_block_sums;
    static constexpr std::size_t half_products = direct_cost(C);
    static constexpr std::size_t pieces = C.output.channels; ///< that different threads may compute
    static constexpr std::size_t totals = C.weights();
    static constexpr std::size_t workspace_elements = 0;

    /// sums[channel][row][column] += the gradient of one lane block, for the pieces [begin, end).
    [[gnu::flatten]] static void add(const T* input, const T* gradient, double* sums, T*, std::size_t begin,
                                     std::size_t end) {
        for (std::size_t channel = begin; channel < end; ++channel)
            for (std::size_t y = 0; y < C.output.rows; y += tile_rows)
                blocked<C.kernel.rows, block_rows>([&](auto rows, std::size_t first_row) {
                    add_tile<rows>(input + channel * C.input.area() * lanes<T>,
                                   gradient + channel * C.output.area() * lanes<T>, y,
                                   std::min(y + tile_rows, C.output.rows), first_row,
                                   sums + channel * C.kernel.area() + first_row * C.kernel.columns);
                });
    }
    static void finish(const double* sums, T* gradients) {
        std::transform(sums, sums + totals, gradients, [](double sum) { return static_cast<T>(sum); });
    }

private:
    static constexpr std::size_t block_rows =
        std::clamp<std::size_t>(max_block_sums / C.kernel.columns, 1, C.kernel.rows);
    static constexpr std::size_t tile_rows = gradient_tile_rows<T>(C, 1);
    static constexpr tap_axis row_axis = C.row_axis(), column_axis = C.column_axis();

    template <std::size_t Rows>
    [[gnu::always_inline]] static void add_tile(const T* input, const T* gradient, std::size_t begin_row,
                                                std::size_t end_row, std::size_t first_row,
                                                double* totals_from) {
        constexpr std::size_t width = lanes<T>, taps = C.kernel.columns;
        std::array<std::array<vector<T>, taps>, Rows> sums;
#pragma GCC unroll 64
        for (std::size_t row = 0; row < Rows; ++row)
#pragma GCC unroll 64
            for (std::size_t tap = 0; tap < taps; ++tap)
                sums[row][tap] = vector<T>(T{});
        for (std::size_t y = begin_row; y < end_row; ++y) {
            const auto limited = [&](std::size_t tap) {
                return std::clamp(tap, first_row, first_row + Rows) - first_row;
            };
            const std::size_t first = limited(row_axis.first_tap(y)), last = limited(row_axis.last_tap(y));
            const std::ptrdiff_t corner = (row_axis.position(y) + static_cast<std::ptrdiff_t>(first_row)) *
                                              static_cast<std::ptrdiff_t>(C.input.columns) +
                                          column_axis.position(0);
            const T* const from = input + corner * static_cast<std::ptrdiff_t>(width);
            const T* const g = gradient + y * C.output.columns * width;
            const auto pixel = [&](auto all_rows, auto all_columns, std::size_t x)
                __attribute__((always_inline)) {
                const vector<T> dy = load(g + x * width);
                const std::size_t first_tap = column_axis.first_tap(x), last_tap = column_axis.last_tap(x);
#pragma GCC unroll 64
                for (std::size_t row = 0; row < Rows; ++row)
#pragma GCC unroll 64
                    for (std::size_t tap = 0; tap < taps; ++tap)
                        if ((all_rows || (row >= first && row < last)) &&
                            (all_columns || (tap >= first_tap && tap < last_tap)))
                            sums[row][tap] = multiply_add(
                                dy,
                                load(from +
                                     static_cast<std::ptrdiff_t>(
                                         (row * C.input.columns + x * C.stride.columns + tap) * width)),
                                sums[row][tap]);
            };
            const auto line = [&](auto all_rows) __attribute__((always_inline)) {
                constexpr std::size_t begin = column_axis.interior_begin(), end = column_axis.interior_end();
                for (std::size_t x = 0; x < begin; ++x)
                    pixel(all_rows, std::false_type{}, x);
                for (std::size_t x = begin; x < end; ++x)
                    pixel(all_rows, std::true_type{}, x);
                for (std::size_t x = end; x < C.output.columns; ++x)
                    pixel(all_rows, std::false_type{}, x);
            };
            if (first == 0 && last == Rows)
                line(std::true_type{});
            else
                line(std::false_type{});
        }
        add_across_lanes<Rows, taps>(sums, totals_from, taps);
    }
};

}}} // namespace tactnet::kernels
