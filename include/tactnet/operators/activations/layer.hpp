#pragma once

#include <tactnet/operators/activations/function.hpp>
#include <tactnet/operators/layer.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <ratio>
#include <string>
#include <string_view>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// The elementwise layer of an activation function, in place unless its gradient needs the input.
/// `activation_function.hpp` shows how to write one.
template <activation_function Function>
struct activation {
    static constexpr std::string_view name = Function::name;
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        constexpr bool from_output = !detail::needs_input<Function>;
        return {.output = input, .in_place = from_output, .keeps_output = from_output};
    }

    template <class T, shape Input>
    using layer = layer_base<T, Input, activation>;
};

/// Rectified linear unit: max(x, 0). In place.
using relu = activation<relu_function>;

/// Parametric ReLU (He, Zhang, Ren, Sun, "Delving deep into rectifiers", 2015): x above 0, otherwise slope ·
/// x, with a learned slope for each channel. PyTorch's nn.PReLU(channels); in weight files "prelu1.weight" of
/// shape [channels]. `initialise` sets slopes to ¼, and weight decay leaves them alone.
struct parametric_relu {
    static constexpr std::string_view name = "prelu";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .parameters = input.channels};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, parametric_relu> {
        static constexpr std::size_t channels = Input.channels;

        static void describe(const std::string& prefix, std::vector<parameter>& list) {
            describe_array(list, prefix, "weight", parameter_role::slope, {channels}, 0);
        }
    };
};

/// y = √(x + offset) − √offset, and 0 for x below 0. As the first layer of a network of counts it stabilises
/// their variance: counts are noisier the larger they are, and the noise of their root is nearly constant
/// (Anscombe, "The transformation of Poisson, binomial and negative-binomial data", 1948, with an offset of ⅜
/// of a count). Zero stays zero. `Offset` is a fraction (std::ratio) above zero in units of the input; the
/// default is ⅜ of a count of 8 bits divided by 255. In place.
template <class Offset = std::ratio<3, 8 * 255>>
struct square_root {
    static constexpr std::string_view name = "square_root";
    static constexpr bool numbered = true;
    static constexpr bool needs_counts =
        true; ///< inputs below 0, as after subtracting a mean image, would be lost
    static_assert(std::ratio_greater_v<Offset, std::ratio<0>>, "square_root: the offset must be above zero");
    static constexpr double offset = static_cast<double>(Offset::num) / static_cast<double>(Offset::den);

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    template <class T, shape Input>
    using layer = layer_base<T, Input, square_root>;
};

/// Softmax over the channels of each pixel, for lists that end in probabilities. The networks of the paper
/// end in logits. Training joins softmax and cross-entropy (training/loss.hpp), which is exact where
/// probabilities are not, so a network has logits whether its list ends in softmax or not.
struct softmax {
    static constexpr std::string_view name = "softmax";
    static constexpr bool numbered = false;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    template <class T, shape Input>
    using layer = layer_base<T, Input, softmax>;
};

namespace detail {

template <unsigned Percent>
[[nodiscard]] constexpr shape dropout_output(shape output) {
    static_assert(Percent < 100, "dropout: the percentage must be below 100");
    return output;
}

} // namespace detail

/// Dropout (Srivastava et al., 2014): training zeroes each element with the given probability in percent and
/// scales the others to keep the mean; inference changes nothing. The mask depends on the seed, the step, the
/// sample and the layer's place in the network alone.
template <unsigned Percent>
struct dropout {
    static constexpr std::string_view name = "dropout";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) { return {.output = input, .in_place = true}; }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, dropout> {
        static constexpr shape output = detail::dropout_output<Percent>(Input);
    };
};

}} // namespace tactnet
