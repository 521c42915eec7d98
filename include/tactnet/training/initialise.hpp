#pragma once

#include <tactnet/operators/layer.hpp>
#include <tactnet/runtime/random.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <variant>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace random_purposes {
inline constexpr random_purpose initial_weights{3}; ///< one array of weights
} // namespace random_purposes

/// Weights from N(0, deviation²), as AlexNet's (Krizhevsky, Sutskever, Hinton, 2012).
struct fixed_normal {
    double deviation = 0.01;
};
/// Weights from N(0, 2 / inputs of one output) (He, Zhang, Ren, Sun, 2015).
struct he_normal {};

/// A rule for the initial weights.
using initialisation = std::variant<fixed_normal, he_normal>;

namespace detail {

/// Initialises one array of a network. `index` counts its arrays of weights.
template <class T>
void initialise(const parameter& p, std::span<T> values, const initialisation& rule, std::uint64_t seed,
                std::uint32_t& index) {
    if (p.role != parameter_role::weight) {
        std::fill(values.begin(), values.end(), static_cast<T>(initial_value(p.role)));
        return;
    }
    const auto* fixed = std::get_if<fixed_normal>(&rule);
    const double deviation = fixed ? fixed->deviation : std::sqrt(2.0 / static_cast<double>(p.fan_in));
    random_stream random(seed, random_purposes::initial_weights, index++);
    for (T& value : values)
        value = static_cast<T>(deviation * random.normal());
}

} // namespace detail

/// Draws all weights at random; biases, shifts and running means become zero, scales and running variances
/// one, slopes ¼.
template <class Network>
void initialise(Network& network, const initialisation& rule, std::uint64_t seed) {
    std::uint32_t index = 0;
    network.for_each_parameter(
        [&](const parameter& p, auto values) { detail::initialise(p, values, rule, seed, index); });
}

}} // namespace tactnet
