#pragma once

#include <tactnet/kernels/arch/compiler_vector.hpp>
#include <tactnet/kernels/integer/rounding.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

// The resize of an image of one channel in integers, and its three channels in bytes.

namespace tactnet { inline namespace TACTNET_ARCH { namespace kernels {

/// `Down` and `Along` are the taps of both axes (resize_axis): of an image of Down::inputs rows of
/// Along::inputs columns.
template <class Down, class Along>
struct integer_photograph {
    /// The unit of the taps, and of each sum of both passes: 1/one of a number of the input.
    static constexpr std::int32_t one = 1 << 13;
    /// Integers of 32 bits between the passes, and of one row after them.
    static constexpr std::size_t workspace = (Down::inputs + 1) * Along::outputs;

private:
    template <class Axis>
    using whole_taps = std::array<std::array<std::int32_t, Axis::taps>, Axis::outputs>;

    /// The taps rounded; the largest of an output takes the rest, so that a constant image stays constant.
    template <class Axis>
    static constexpr whole_taps<Axis> rounded_taps() {
        whole_taps<Axis> all{};
        for (std::size_t o = 0; o < Axis::outputs; ++o) {
            std::int32_t rest = one;
            std::size_t largest = 0;
            for (std::size_t t = 0; t < Axis::taps; ++t) {
                const float exact = Axis::table[o].weights[t] * one;
                all[o][t] = static_cast<std::int32_t>(exact < 0 ? exact - 0.5f : exact + 0.5f);
                rest -= all[o][t];
                if (all[o][t] > all[o][largest])
                    largest = t;
            }
            all[o][largest] += rest;
        }
        return all;
    }
    template <class Axis>
    static constexpr std::int32_t largest_gain(const whole_taps<Axis>& taps) {
        std::int32_t most = 0;
        for (const auto& of_output : taps) {
            std::int32_t sum = 0;
            for (const std::int32_t tap : of_output)
                sum += tap < 0 ? -tap : tap;
            most = sum > most ? sum : most;
        }
        return most;
    }
    static constexpr whole_taps<Down> down = rounded_taps<Down>();
    static constexpr whole_taps<Along> along = rounded_taps<Along>();
    // A word of 16 bits times both gains has 31 bits: 32768 · 1.5² · 2¹³ < 2³¹.
    static_assert(largest_gain<Down>(down) <= one * 3 / 2 && largest_gain<Along>(along) <= one * 3 / 2,
                  "integer_photograph: the taps would overflow");

public:
    /// Resizes `input(pixel)`, words of 16 bits, and writes four bytes for each pixel: the sum minus each of
    /// `starts`, times each of `factors`, rounded to the range. Both products are single, so that they are
    /// the same on all instruction sets.
    template <class Words>
    static void run(Words&& input, const float_vec<4>& starts, const float_vec<4>& factors,
                    const byte_range& range, std::int32_t* memory, std::uint8_t* output) noexcept {
        for (std::size_t y = 0; y < Down::inputs; ++y)
            for (std::size_t x = 0; x < Along::outputs; ++x) {
                std::int32_t sum = one / 2;
                for (std::size_t t = 0; t < Along::taps; ++t)
                    sum += along[x][t] * input(y * Along::inputs + Along::table[x].first + t);
                memory[y * Along::outputs + x] = sum >> 13;
            }
        std::int32_t* const row = memory + Down::inputs * Along::outputs;
        for (std::size_t y = 0; y < Down::outputs; ++y) {
            const std::int32_t* const above = memory + Down::table[y].first * Along::outputs;
            for (std::size_t x = 0; x < Along::outputs; ++x)
                row[x] = 0;
            for (std::size_t t = 0; t < Down::taps; ++t)
                for (std::size_t x = 0; x < Along::outputs; ++x)
                    row[x] += down[y][t] * above[t * Along::outputs + x];
            for (std::size_t x = 0; x < Along::outputs; ++x, output += 4) {
                const float_vec<4> sums = static_cast<float>(row[x]) - float_vec<4>{};
                store_rounded<4>(output, float_vec<4>((sums - starts) * factors), range);
            }
        }
    }
};

}}} // namespace tactnet::kernels
