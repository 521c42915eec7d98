#pragma once

#include <tactnet/deployment/steps/batch_executor.hpp>
#include <tactnet/deployment/steps/step.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The skip of a residual block that passes its input on.
struct no_step {
    static constexpr std::size_t folded = 0, packed = 0, workspace_elements = 0;
    static constexpr void pack(const float*, auto*) {}
    static double output_bound(const float*, double input) { return input; }
};

/// main(x) + skip(x), with the ReLU behind it. The skip is left in the output, and the main branch's last
/// convolution adds to it. The input has `InputStride` elements from one pixel to the next.
template <class Main, class Skip, std::size_t InputStride>
struct residual_step {
    using format = typename Main::format;
    using activation = typename format::activation;
    using packed_number = typename format::packed;
    static constexpr shape output = Main::output;
    static constexpr std::size_t output_stride = Main::output_stride;
    static constexpr std::size_t folded = Main::folded + Skip::folded, packed = Main::packed + Skip::packed;
    /// Where the skip's pixels are not as far apart as the output's, it is computed aside.
    static constexpr std::size_t aside = [] {
        if constexpr (std::is_same_v<Skip, no_step>)
            return std::size_t{0};
        else
            return Skip::output_stride == output_stride
                       ? 0
                       : whole_lines<activation>(output.area() * Skip::output_stride);
    }();
    static constexpr std::size_t workspace_elements =
        std::max(Main::workspace_elements, aside + Skip::workspace_elements);

    static constexpr bool large = detail::is_large<Main> || detail::is_large<Skip>;

    static constexpr void pack(const float* from, packed_number* to) {
        Main::pack(from, to);
        Skip::pack(from + Main::folded, to + Main::packed);
    }
    static double output_bound(const float* from, double input) {
        return Main::output_bound(from, input) + Skip::output_bound(from + Main::folded, input);
    }
    static void run(const packed_number* packed_values, const activation* in, activation* out,
                    activation* memory) noexcept {
        leave_skip(packed_values, in, out, memory);
        Main::run(packed_values, in, out, memory);
    }
    /// Its first half: the skip, in the output.
    static void leave_skip(const packed_number* packed_values, const activation* in, activation* out,
                           activation* memory) noexcept {
        if constexpr (std::is_same_v<Skip, no_step>) {
            copy_pixels<InputStride>(in, out);
        } else if constexpr (aside == 0) {
            Skip::run(packed_values + Main::packed, in, out, memory);
        } else {
            Skip::run(packed_values + Main::packed, in, memory, memory + aside);
            copy_pixels<Skip::output_stride>(memory, out);
        }
    }
    template <class Executor>
        requires(aside == 0)
    static void run_batch(const packed_number* packed_values, const activation* in, std::size_t in_distance,
                          activation* out, activation* memory, const Executor& executor) {
        if constexpr (std::is_same_v<Skip, no_step>)
            executor.for_each_frame([&](std::size_t frame) {
                copy_pixels<InputStride>(in + frame * in_distance,
                                         out + frame * detail::map_distance<residual_step>);
            });
        else
            detail::run_batch<Skip>(packed_values + Main::packed, in, in_distance, out, memory, executor);
        detail::run_batch<Main>(packed_values, in, in_distance, out, memory, executor);
    }

private:
    template <std::size_t Stride>
    static void copy_pixels(const activation* from, activation* to) {
        if constexpr (Stride == output_stride) {
            std::copy_n(from, output.area() * output_stride, to);
        } else {
            for (std::size_t pixel = 0; pixel < output.area(); ++pixel) {
                activation* const end =
                    std::copy_n(from + pixel * Stride, output.channels, to + pixel * output_stride);
                std::fill(end, to + (pixel + 1) * output_stride, activation{});
            }
        }
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
