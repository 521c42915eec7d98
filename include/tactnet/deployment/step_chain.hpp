#pragma once

#include <tactnet/deployment/steps.hpp>
#include <tactnet/detail/indexed_leaves.hpp>

#include <algorithm>
#include <cstddef>
#include <type_traits>
#include <utility>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Steps one after the other, as one step. Maps between them lie in two buffers that take turns.
template <class... Steps>
struct step_chain {
    static constexpr std::size_t size = sizeof...(Steps);
    static_assert(size > 0, "step_chain: there must be at least one step");
    template <std::size_t I>
    using at = typename decltype(detail::type_at<I>(
        std::declval<detail::indexed_leaves<std::type_identity<Steps>...>>()))::type;

    static constexpr shape output = at<size - 1>::output;
    static constexpr std::size_t output_stride = at<size - 1>::output_stride;
    static constexpr std::size_t folded = (Steps::folded + ...), packed = (Steps::packed + ...);
    /// The largest map between two steps.
    static constexpr std::size_t buffer = [] {
        std::size_t most = 0;
        kernels::unroll<size - 1>(
            [&](auto i) { most = std::max(most, whole_lines(at<i>::output.area() * at<i>::output_stride)); });
        return most;
    }();
    static constexpr std::size_t buffers = std::min<std::size_t>(size - 1, 2);
    static constexpr std::size_t scratch = buffers * buffer + std::max({Steps::scratch...});

    static constexpr void pack(const float* from, float* to) {
        ((Steps::pack(from, to), from += Steps::folded, to += Steps::packed), ...);
    }
    /// Of all steps, not only the last: maps between them must stay finite as well.
    static double reach(const float* from, double input) {
        double most = input;
        ((input = Steps::reach(from, input), most = std::max(most, input), from += Steps::folded), ...);
        return most;
    }
    static void run(const float* packed_values, const float* in, float* out, float* memory) noexcept {
        float* const inner = memory + buffers * buffer;
        kernels::unroll<size>([&](auto i) {
            float* const to = i + 1 == size ? out : memory + i % 2 * buffer;
            at<i>::run(packed_values, in, to, inner);
            packed_values += at<i>::packed;
            in = to;
        });
    }
};

/// The skip of a residual block that passes its input on.
struct no_step {
    static constexpr std::size_t folded = 0, packed = 0, scratch = 0;
    static constexpr void pack(const float*, float*) {}
    static double reach(const float*, double input) { return input; }
};

/// main(x) + skip(x), with the ReLU behind it. The skip is left in the output, and the main branch's last
/// convolution adds to it. The input has `InputStride` elements from one pixel to the next.
template <class Main, class Skip, std::size_t InputStride>
struct residual_step {
    static constexpr shape output = Main::output;
    static constexpr std::size_t output_stride = Main::output_stride;
    static constexpr std::size_t folded = Main::folded + Skip::folded, packed = Main::packed + Skip::packed;
    /// Where the skip's pixels are not as far apart as the output's, it is computed aside.
    static constexpr std::size_t aside = [] {
        if constexpr (std::is_same_v<Skip, no_step>)
            return std::size_t{0};
        else
            return Skip::output_stride == output_stride ? 0
                                                        : whole_lines(output.area() * Skip::output_stride);
    }();
    static constexpr std::size_t scratch = std::max(Main::scratch, aside + Skip::scratch);

    static constexpr void pack(const float* from, float* to) {
        Main::pack(from, to);
        Skip::pack(from + Main::folded, to + Main::packed);
    }
    static double reach(const float* from, double input) {
        return Main::reach(from, input) + Skip::reach(from + Main::folded, input);
    }
    static void run(const float* packed_values, const float* in, float* out, float* memory) noexcept {
        if constexpr (std::is_same_v<Skip, no_step>) {
            copy_pixels<InputStride>(in, out);
        } else if constexpr (aside == 0) {
            Skip::run(packed_values + Main::packed, in, out, memory);
        } else {
            Skip::run(packed_values + Main::packed, in, memory, memory + aside);
            copy_pixels<Skip::output_stride>(memory, out);
        }
        Main::run(packed_values, in, out, memory);
    }

private:
    template <std::size_t Stride>
    static void copy_pixels(const float* from, float* to) {
        if constexpr (Stride == output_stride) {
            std::copy_n(from, output.area() * output_stride, to);
        } else {
            for (std::size_t pixel = 0; pixel < output.area(); ++pixel) {
                float* const end =
                    std::copy_n(from + pixel * Stride, output.channels, to + pixel * output_stride);
                std::fill(end, to + (pixel + 1) * output_stride, 0.0f);
            }
        }
    }
};

} // namespace TACTNET_ARCH
} // namespace tactnet
