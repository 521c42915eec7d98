#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/operators/layer.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <variant>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Stochastic gradient descent with momentum. `l2` times the weights is added to their gradient, but not to
/// the gradient of biases.
struct sgd {
    double momentum = 0.9;
    double l2 = 0;
    bool l2_of_norms = false; ///< scales and shifts of batch norms too, as the authors' programs do
};

/// Adam with decoupled weight decay (Loshchilov and Hutter, 2019), on weights only. A gradient beyond 1.8e19
/// ÷ √(1 − beta2), by default 1.8e20, has a square beyond single precision: `second` is then infinite, and
/// its parameter never changes again. Training throws at the end of the epoch.
struct adamw {
    double beta1 = 0.9, beta2 = 0.99;
    double decay = 0.05;
    double epsilon = 1e-8;
};

/// A rule for the update of parameters.
using optimiser = std::variant<sgd, adamw>;

/// The state of an optimiser.
template <class T>
struct optimiser_state {
    aligned_vector<T> first, second;
    std::uint64_t steps = 0;

    void resize(std::size_t parameters) {
        first.assign(parameters, T{});
        second.assign(parameters, T{});
        steps = 0;
    }
};

namespace detail {

/// The mask of weight decay: one for weights, and for scales and shifts of batch norms if the rule says
/// so, else zero, up to a whole vector.
inline aligned_vector<float> decay_mask(const optimiser& rule, const std::vector<parameter>& parameters,
                                        std::size_t size) {
    const auto* const descent = std::get_if<sgd>(&rule);
    const bool norms = descent && descent->l2_of_norms;
    aligned_vector<float> mask(size, 0.0f);
    for (const parameter& p : parameters)
        if (p.role == parameter_role::weight ||
            (norms && (p.role == parameter_role::scale || p.role == parameter_role::shift)))
            std::fill_n(mask.begin() + static_cast<std::ptrdiff_t>(p.offset), p.size, 1.0f);
    return mask;
}

/// The shares of the learning rate from element `i` on; an empty span means the whole rate.
template <class T>
[[nodiscard]] kernels::vector<T> rate_share(std::span<const T> shares, std::size_t i) {
    return shares.empty() ? kernels::vector<T>(T{1}) : kernels::load(&shares[i]);
}

/// Flushes denormal numbers to zero. The momentum of a parameter without gradients decays until it is
/// denormal, where it stays (0.9 times the smallest number rounds back to it), and slows down every step on
/// most processors.
template <class T>
[[nodiscard]] kernels::vector<T> without_denormals(const kernels::vector<T>& x) {
    const kernels::vector<T> zero(T{}), least(std::numeric_limits<T>::min());
    return kernels::choose<T>((x < least) && (zero - x < least), zero, x);
}
/// Clamps positive numbers whose root is a divisor to 2^-116, which decays without becoming denormal and
/// whose root is negligible compared with an epsilon of 1e-8. Zero stays zero.
template <class T>
[[nodiscard]] kernels::vector<T> without_denormal_divisors(const kernels::vector<T>& x) {
    const kernels::vector<T> zero(T{}), least(static_cast<T>(0x1p-116));
    return kernels::choose<T>((x < least) && (x > zero), least, x);
}

} // namespace detail

/// Takes one step over flat arrays, each padded to whole vectors (see padded_size). `decayed` is one where
/// weight decay applies, else zero. `rate` is the learning rate of this step; `shares`, unless empty, scale
/// it for each parameter: 0 leaves a parameter unchanged.
template <class T>
void optimiser_step(const sgd& rule, optimiser_state<T>& state, double rate, std::span<T> values,
                    std::span<const T> gradients, std::span<const T> decayed,
                    std::span<const T> shares = {}) {
    ++state.steps;
    const kernels::vector<T> momentum(static_cast<T>(rule.momentum)), l2(static_cast<T>(rule.l2)),
        r(static_cast<T>(rate));
    for (std::size_t i = 0; i < values.size(); i += kernels::lanes<T>) {
        const kernels::vector<T> value = kernels::load<T>(&values[i]);
        const kernels::vector<T> gradient =
            kernels::multiply_add<T>(l2 * kernels::load(&decayed[i]), value, kernels::load(&gradients[i]));
        const kernels::vector<T> velocity = detail::without_denormals<T>(
            kernels::multiply_add<T>(momentum, kernels::load<T>(&state.first[i]), gradient));
        kernels::store(&state.first[i], velocity);
        kernels::store(&values[i], value - r * detail::rate_share(shares, i) * velocity);
    }
}

/// One step of AdamW.
template <class T>
void optimiser_step(const adamw& rule, optimiser_state<T>& state, double rate, std::span<T> values,
                    std::span<const T> gradients, std::span<const T> decayed,
                    std::span<const T> shares = {}) {
    ++state.steps;
    const auto steps = static_cast<double>(state.steps);
    const double correction1 = 1 - std::pow(rule.beta1, steps), correction2 = 1 - std::pow(rule.beta2, steps);
    const kernels::vector<T> beta1(static_cast<T>(rule.beta1)), rest1(static_cast<T>(1 - rule.beta1));
    const kernels::vector<T> beta2(static_cast<T>(rule.beta2)), rest2(static_cast<T>(1 - rule.beta2));
    const kernels::vector<T> step(static_cast<T>(rate / correction1)),
        unbias(static_cast<T>(1 / std::sqrt(correction2)));
    const kernels::vector<T> epsilon(static_cast<T>(rule.epsilon)), decay(static_cast<T>(rate * rule.decay));
    for (std::size_t i = 0; i < values.size(); i += kernels::lanes<T>) {
        const kernels::vector<T> value = kernels::load<T>(&values[i]),
                                 gradient = kernels::load(&gradients[i]);
        const kernels::vector<T> first = detail::without_denormals<T>(
            kernels::multiply_add<T>(beta1, kernels::load<T>(&state.first[i]), rest1 * gradient));
        const kernels::vector<T> second = detail::without_denormal_divisors<T>(
            kernels::multiply_add<T>(beta2, kernels::load<T>(&state.second[i]), rest2 * gradient * gradient));
        kernels::store(&state.first[i], first);
        kernels::store(&state.second[i], second);
        const kernels::vector<T> share = detail::rate_share(shares, i);
        const kernels::vector<T> shrunk = value - decay * share * kernels::load(&decayed[i]) * value;
        kernels::store(&values[i], shrunk - kernels::quotient<kernels::vector<T>>(
                                                step * share * first,
                                                kernels::square_root<T>(second) * unbias + epsilon));
    }
}

/// One step of the chosen rule.
template <class T>
void optimiser_step(const optimiser& rule, optimiser_state<T>& state, double rate, std::span<T> values,
                    std::span<const T> gradients, std::span<const T> decayed,
                    std::span<const T> shares = {}) {
    std::visit(
        [&](const auto& chosen) { optimiser_step(chosen, state, rate, values, gradients, decayed, shares); },
        rule);
}

}} // namespace tactnet
