#pragma once

#include <tactnet/kernels/simd/float_lanes.hpp>
#include <tactnet/operators/activations/function.hpp>

#include <array>
#include <concepts>

namespace own { inline namespace TACTNET_ARCH {

/// An activation function of a user that takes vectors: x ÷ (c + |x|), with c in hundredths.
template <unsigned Hundredths>
struct softsign_function {
    static constexpr const char *name = "softsign", *title = "Softsign", *type = "own::softsign_function",
                                *header = "deployment/export/softsign.hpp";
    static constexpr std::array arguments{Hundredths};
    static constexpr bool works_on_vectors = true;
    static constexpr double largest_value = 1;

    template <class Number>
    static constexpr Number divisor(const Number& x) {
        if constexpr (std::same_as<Number, double>)
            return Hundredths / 100.0 + tactnet::kernels::magnitude(x);
        else
            return Number(static_cast<float>(Hundredths) / 100) + tactnet::kernels::magnitude(x);
    }
    template <class Number>
    static constexpr Number value(const Number& x) {
        return x / divisor(x);
    }
    /// c ÷ (c + |x|)².
    template <class Number>
    static constexpr Number backward_from_input(const Number& x, const Number& gradient) {
        const Number whole = divisor(x);
        return gradient * ((whole - tactnet::kernels::magnitude(x)) / whole / whole);
    }
};

template <unsigned Hundredths>
using softsign = tactnet::activation<softsign_function<Hundredths>>;

}} // namespace own::TACTNET_ARCH
