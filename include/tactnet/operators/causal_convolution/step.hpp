#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/kernels/frame/dense.hpp>
#include <tactnet/lowering/step.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// The frames before the present one that a causal convolution looks back to, zero at first, in a ring.
template <class Number, std::size_t Features, std::size_t Taps, std::size_t Dilation>
struct frame_ring {
    static constexpr std::size_t frames = (Taps - 1) * Dilation;
    std::array<Number, frames * Features> elements{};
    std::uint32_t next = 0; ///< the oldest, below `frames`

    /// `next`, of whatever bytes: a caller may have filled the state with damaged ones.
    [[nodiscard]] std::size_t oldest() const noexcept { return next < frames ? next : 0; }

    /// The features of the frame (Taps − 1 − tap) · Dilation before the present one, for all taps but the
    /// last.
    [[nodiscard]] const Number* before(std::size_t tap) const noexcept {
        std::size_t frame = oldest() + tap * Dilation; // this far after the oldest
        if (frame >= frames)
            frame -= frames;
        return elements.data() + frame * Features;
    }
    /// Where the features of the present frame take the place of the oldest. Call it once for each frame.
    [[nodiscard]] Number* replace_oldest() noexcept {
        const std::size_t place = oldest();
        next = static_cast<std::uint32_t>(place + 1 == frames ? 0 : place + 1);
        return elements.data() + place * Features;
    }
};

/// The base of steps that look back, if there are several taps.
template <class Number, std::size_t Features, std::size_t Taps, std::size_t Dilation>
struct looks_back {
    using state = frame_ring<Number, Features, Taps, Dilation>;
};
template <class Number, std::size_t Features, std::size_t Dilation>
struct looks_back<Number, Features, 1, Dilation> {};

} // namespace detail

/// A causal convolution on one frame of a stream, with the ReLU after it or without. With one tap it is a
/// dense layer and remembers nothing.
template <class Format, std::size_t Features, std::size_t Filters, std::size_t Taps, std::size_t Dilation,
          bool Rectified>
struct causal_step;
template <class Format, std::size_t Features, std::size_t Filters, std::size_t Taps, std::size_t Dilation,
          bool Rectified>
struct step_description<causal_step<Format, Features, Filters, Taps, Dilation, Rectified>> {
    static constexpr const char* header = "tactnet/operators/causal_convolution/step.hpp";
    static constexpr void visit(auto&& to) {
        constexpr const char* titles[] = {"Dense", "Dense, ReLU", "Causal convolution",
                                          "Causal convolution, ReLU"};
        to("tactnet::causal_step", titles[(Taps > 1 ? 2 : 0) + (Rectified ? 1 : 0)],
           std::type_identity<Format>{}, Features, Filters, Taps, Dilation, Rectified);
    }
};

template <std::size_t Features, std::size_t Filters, std::size_t Taps, std::size_t Dilation, bool Rectified>
struct causal_step<single_precision, Features, Filters, Taps, Dilation, Rectified>
    : step_base<single_precision, shape{1, 1, Filters}, kernels::padded_size<float>(Filters)>,
      detail::looks_back<float, Features, Taps, Dilation> {
private:
    static constexpr std::size_t inputs = Features * Taps; // of one output
    using product = kernels::ordered_product<Filters, inputs>;

public:
    static constexpr std::size_t folded_elements = Filters * (inputs + 1),
                                 packed_elements = product::packed_elements;

    static constexpr void pack(const float* values, float* packed) {
        product::pack([&](std::size_t row, std::size_t input) { return values[row * inputs + input]; },
                      [&](std::size_t row) { return values[Filters * inputs + row]; }, packed);
    }
    static void run(const float* packed, const float* in, float* out, float*, auto&... states) noexcept {
        if constexpr (Taps == 1)
            product::run(packed, in, out);
        else
            product::run(packed, look_back(in, states...).data(), out);
        if constexpr (Rectified)
            kernels::relu_forward(out, out, causal_step::output_stride);
    }
    [[nodiscard]] static double output_bound(const float* values, double input) {
        return detail::largest_sum(values, Filters, inputs, input);
    }

private:
    /// The inputs of an output, [feature][tap]; the present frame takes the place of the oldest.
    static std::array<float, inputs> look_back(const float* in, auto& state) noexcept {
        std::array<float, inputs> found;
        for (std::size_t tap = 0; tap < Taps; ++tap) {
            const float* const from = tap + 1 == Taps ? in : state.before(tap);
            for (std::size_t f = 0; f < Features; ++f)
                found[f * Taps + tap] = from[f];
        }
        std::copy_n(in, Features, state.replace_oldest());
        return found;
    }
};

}} // namespace tactnet
