#pragma once

// The reference of a layer specification.

#include <tactnet/operators.hpp>
#include <tactnet/operators/lowering.hpp>
#include <tactnet/operators/norm_relu_pool/training.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <support/layers/plain_reference.hpp>
#include <support/layers/reference.hpp>
#include <support/layers/reference_of_maps.hpp>
#include <utility>
#include <vector>

namespace support {

/// Of an operator that has none below: what it says itself that it computes.
template <class Spec>
struct reference_of {
    static reference_pointer on(extents3 in) { return std::make_unique<plain_reference<Spec>>(in); }
};

template <std::size_t Filters, tactnet::extent2d Kernel, tactnet::extent2d Stride, tactnet::padding Padding,
          tactnet::conv2d_options Options>
struct reference_of<tactnet::conv2d<Filters, Kernel, Stride, Padding, Options>> {
    static reference_pointer on(extents3 in) {
        return reference_convolution(window_over(in, Kernel, Stride, Padding), Filters, Options.groups,
                                     Options.bias,
                                     tiles_of_convolution({in.rows, in.columns, in.channels}, Kernel, Stride,
                                                          Padding, Filters, Options.groups));
    }
};
template <std::size_t Outputs>
struct reference_of<tactnet::dense<Outputs>> {
    static reference_pointer on(extents3 in) { return reference_dense(in, Outputs); }
};
template <>
struct reference_of<tactnet::batch_norm> {
    static reference_pointer on(extents3 in) { return reference_batch_norm(in); }
};
template <>
struct reference_of<tactnet::channel_scale> {
    static reference_pointer on(extents3 in) { return reference_channel_scale(in); }
};
template <std::size_t Groups>
struct reference_of<tactnet::group_norm<Groups>> {
    static reference_pointer on(extents3 in) { return reference_group_norm(in, Groups); }
};
template <>
struct reference_of<tactnet::instance_norm> {
    static reference_pointer on(extents3 in) { return reference_group_norm(in, in.channels); }
};
template <tactnet::norm_over Over>
struct reference_of<tactnet::layer_norm<Over>> {
    static reference_pointer on(extents3 in) {
        return reference_layer_norm(in, Over == tactnet::norm_over::channels);
    }
};
template <>
struct reference_of<tactnet::relu> {
    static reference_pointer on(extents3 in) { return reference_relu(in); }
};
template <>
struct reference_of<tactnet::parametric_relu> {
    static reference_pointer on(extents3 in) { return reference_parametric_relu(in); }
};
/// Values and derivatives by the standard library.
template <unsigned Thousandths>
struct reference_of<tactnet::leaky_relu<Thousandths>> {
    static constexpr double slope = Thousandths / 1000.0;
    static reference_pointer on(extents3 in) {
        // The slope is rounded, and the product.
        return reference_activation(in, {[](double x) { return x > 0 ? x : slope * x; },
                                         [](double x) { return x > 0 ? 1 : slope; }, 2, 2});
    }
};
template <>
struct reference_of<tactnet::relu6> {
    static reference_pointer on(extents3 in) {
        return reference_activation(in, {[](double x) { return std::clamp(x, 0.0, 6.0); },
                                         [](double x) { return x > 0 && x < 6 ? 1.0 : 0.0; }});
    }
};
template <>
struct reference_of<tactnet::hard_sigmoid> {
    static double value(double x) { return std::clamp((x + 3) / 6, 0.0, 1.0); }
    static reference_pointer on(extents3 in) {
        return reference_activation(
            in, {value, [](double x) { return std::abs(x) < 3 ? 1 / 6.0 : 0.0; }, 2, 1, 1 / 6.0});
    }
};
template <>
struct reference_of<tactnet::hard_swish> {
    static reference_pointer on(extents3 in) {
        // The derivative is x/3 + 1/2, whose terms may cancel: its error is relative to the larger of them.
        return reference_activation(
            in, {[](double x) { return x * std::clamp((x + 3) / 6, 0.0, 1.0); },
                 [](double x) { return x <= -3  ? 0.0
                                       : x >= 3 ? 1.0
                                                : (2 * x + 3) / 6; }, 3, 4, 1.5});
    }
};
template <>
struct reference_of<tactnet::sigmoid> {
    static double value(double x) { return 1 / (1 + std::exp(-x)); }
    static reference_pointer on(extents3 in) {
        return reference_activation(in, {value, [](double x) { return value(x) * value(-x); }, 8, 8, 0.25});
    }
};
template <>
struct reference_of<tactnet::silu> {
    using sigmoid = reference_of<tactnet::sigmoid>;
    static double derivative(double x) { return sigmoid::value(x) * (1 + x * sigmoid::value(-x)); }
    static reference_pointer on(extents3 in) {
        return reference_activation(
            in, {[](double x) { return x * sigmoid::value(x); }, derivative, 10, 24, 1.1});
    }
};
template <>
struct reference_of<tactnet::hyperbolic_tangent> {
    static double derivative(double x) { return 1 / (std::cosh(x) * std::cosh(x)); }
    static reference_pointer on(extents3 in) {
        return reference_activation(in, {[](double x) { return std::tanh(x); }, derivative, 4, 8});
    }
};
template <unsigned Thousandths>
struct reference_of<tactnet::elu<Thousandths>> {
    static constexpr double alpha = Thousandths / 1000.0, largest_slope = alpha > 1 ? alpha : 1;
    static reference_pointer on(extents3 in) {
        // The derivative below 0 is alpha + y: its error is relative to alpha.
        return reference_activation(in, {[](double x) { return x > 0 ? x : alpha * std::expm1(x); },
                                         [](double x) { return x > 0 ? 1 : alpha * std::exp(x); }, 10,
                                         12 * largest_slope, largest_slope});
    }
};
template <>
struct reference_of<tactnet::softplus> {
    static reference_pointer on(extents3 in) {
        return reference_activation(in, {[](double x) { return std::log1p(std::exp(x)); },
                                         reference_of<tactnet::sigmoid>::value, 8, 24});
    }
};
template <>
struct reference_of<tactnet::gelu> {
    static double distribution(double x) { return std::erfc(-x / std::sqrt(2.0)) / 2; }
    static double derivative(double x) {
        return distribution(x) + x * std::exp(-x * x / 2) / std::sqrt(2 * std::numbers::pi);
    }
    static reference_pointer on(extents3 in) {
        return reference_activation(in,
                                    {[](double x) { return x * distribution(x); }, derivative, 16, 32, 1.13});
    }
};
template <tactnet::extent2d Window, tactnet::extent2d Stride, tactnet::padding Padding>
struct reference_of<tactnet::max_pool<Window, Stride, Padding>> {
    static reference_pointer on(extents3 in) {
        return reference_max_pool(window_over(in, Window, Stride, Padding));
    }
};
template <>
struct reference_of<tactnet::global_max_pool> {
    static reference_pointer on(extents3 in) {
        return reference_max_pool({in, in.rows, in.columns, 1, 1, 0, 0, 0, 0});
    }
};
template <tactnet::extent2d Window, tactnet::extent2d Stride, tactnet::padding Padding>
struct reference_of<tactnet::norm_relu_pool<Window, Stride, Padding>> {
    static reference_pointer on(extents3 in) {
        std::vector<reference_pointer> layers;
        layers.push_back(reference_batch_norm(in));
        layers.push_back(reference_relu(in));
        layers.push_back(reference_of<tactnet::max_pool<Window, Stride, Padding>>::on(in));
        return reference_sequence(in, std::move(layers));
    }
};
template <tactnet::extent2d Window, tactnet::extent2d Stride, tactnet::padding Padding,
          tactnet::average_over Over>
struct reference_of<tactnet::average_pool<Window, Stride, Padding, Over>> {
    static reference_pointer on(extents3 in) {
        const reference_window window = window_over(in, Window, Stride, Padding);
        const bool completed = Padding.how == tactnet::padding::rule::ceil_mode;
        return reference_average_pool(window, Over == tactnet::average_over::pixels_and_padding,
                                      completed ? Padding.bottom : window.bottom,
                                      completed ? Padding.right : window.right);
    }
};
template <tactnet::extent2d Output>
struct reference_of<tactnet::adaptive_average_pool<Output>> {
    static reference_pointer on(extents3 in) {
        return reference_adaptive_average(in, Output.rows, Output.columns);
    }
};
template <tactnet::extent2d Output>
struct reference_of<tactnet::adaptive_max_pool<Output>> {
    static reference_pointer on(extents3 in) {
        return reference_adaptive_max(in, Output.rows, Output.columns);
    }
};
template <std::size_t Size, class Alpha, class Beta, class K>
struct reference_of<tactnet::local_response_norm<Size, Alpha, Beta, K>> {
    static reference_pointer on(extents3 in) {
        const auto value = [](std::intmax_t over, std::intmax_t under) {
            return static_cast<double>(over) / static_cast<double>(under);
        };
        return reference_local_response_norm(in, Size, value(Alpha::num, Alpha::den),
                                             value(Beta::num, Beta::den), value(K::num, K::den));
    }
};
template <class Offset>
struct reference_of<tactnet::square_root<Offset>> {
    static reference_pointer on(extents3 in) {
        return reference_square_root(in, static_cast<double>(Offset::num) / static_cast<double>(Offset::den));
    }
};
template <tactnet::name_text Name, class Spec>
struct reference_of<tactnet::named<Name, Spec>> : reference_of<Spec> {};
template <class... Branches>
struct reference_of<tactnet::concatenation<Branches...>> {
    static reference_pointer on(extents3 in) {
        std::vector<reference_pointer> branches;
        (branches.push_back(reference_of<tactnet::as_sequence<Branches>>::on(in)), ...);
        return reference_concatenation(std::move(branches));
    }
};
template <>
struct reference_of<tactnet::softmax> {
    static reference_pointer on(extents3 in) { return reference_softmax(in); }
};
template <unsigned Percent>
struct reference_of<tactnet::dropout<Percent>> {
    static reference_pointer on(extents3 in) { return reference_identity(in); }
};
template <class... Specs>
struct reference_of<tactnet::sequence<Specs...>> {
    static reference_pointer on(extents3 in) {
        std::vector<reference_pointer> layers;
        (append<Specs>(layers, in), ...);
        return reference_sequence(in, std::move(layers));
    }

private:
    template <class Spec>
    static void append(std::vector<reference_pointer>& layers, extents3 first) {
        layers.push_back(reference_of<Spec>::on(layers.empty() ? first : layers.back()->output));
    }
};
template <class Main, class Skip>
struct reference_of<tactnet::residual<Main, Skip>> {
    static reference_pointer on(extents3 in) {
        return reference_residual(reference_of<tactnet::as_sequence<Main>>::on(in),
                                  reference_of<tactnet::as_sequence<Skip>>::on(in));
    }
};

template <class... Branch>
struct reference_of<tactnet::gate<Branch...>> {
    static reference_pointer on(extents3 in) {
        return reference_gate(reference_of<tactnet::sequence<Branch...>>::on(in));
    }
};

template <std::size_t Hidden>
struct reference_of<tactnet::gru<Hidden>> {
    static reference_pointer on(extents3 in) { return reference_gru(in, Hidden); }
};
template <std::size_t Hidden>
struct reference_of<tactnet::lstm<Hidden>> {
    static reference_pointer on(extents3 in) { return reference_lstm(in, Hidden); }
};
template <std::size_t Filters, std::size_t Taps, std::size_t Dilation>
struct reference_of<tactnet::causal_conv1d<Filters, Taps, Dilation>> {
    static reference_pointer on(extents3 in) { return reference_causal_conv1d(in, Filters, Taps, Dilation); }
};
template <>
struct reference_of<tactnet::last_frame> {
    static reference_pointer on(extents3 in) { return reference_last_frame(in); }
};

} // namespace support
