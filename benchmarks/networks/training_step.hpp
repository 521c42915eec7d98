#pragma once

#include "../support/measure.hpp"
#include "../support/peak.hpp"

#include <tactnet/training.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <vector>

// Images per second in inference and in training steps of a network, on one core, compared with the core's
// own multiply-add peak measured in the same run. Every timed step is checked: the logits of the last run
// must be those of the first to the bit.

namespace benchmark {

/// Multiply-adds per second of this core.
inline double peak_multiply_adds(std::size_t rounds) {
    float check = 1;
    const auto t = time_rounds(rounds, [&] { check = std::isfinite(run_chains(check)) ? 1.0f : 0.0f; });
    if (check != 1.0f)
        std::abort();
    return static_cast<double>(multiply_adds_of_chains) / t.fastest;
}

template <class Network>
struct fixture {
    using value = typename Network::value_type;
    Network network;
    typename Network::workspace space;
    typename Network::input_batch in;
    typename Network::output_batch out, gradient;
    std::vector<std::size_t> labels;
    tactnet::aligned_vector<value> parameter_gradients, decayed;
    tactnet::optimiser_state<value> state;
    double loss = 0;

    explicit fixture(std::size_t samples)
        : in(samples),
          out(samples),
          gradient(samples),
          labels(samples),
          parameter_gradients(network.learnable_values().size()),
          decayed(network.learnable_values().size(), 1) {
        state.resize(decayed.size());
        tactnet::initialise(network, tactnet::he_normal{}, 1);
        tactnet::random_stream random(1, tactnet::random_purposes::order);
        for (std::size_t s = 0; s < samples; ++s) {
            for (std::size_t e = 0; e < Network::input_shape.size(); ++e)
                in(s, e) = static_cast<value>(random.uniform(-20, 100));
            labels[s] = s % Network::outputs;
        }
    }
    void infer(tactnet::thread_pool& threads) {
        network.prepare(threads, space);
        network.infer(in, out, threads, space);
    }
    /// A whole step of stochastic gradient descent, with rates as in the recipes.
    void train(tactnet::thread_pool& threads) {
        find_gradients(threads);
        tactnet::optimiser_step<value>(tactnet::sgd{.momentum = 0.8, .l2 = 1e-4}, state, 1e-3,
                                       network.learnable_values(), parameter_gradients, decayed);
    }
    void find_gradients(tactnet::thread_pool& threads) {
        network.prepare(threads, space);
        network.forward(in, out, threads, space);
        loss = tactnet::softmax_cross_entropy(out.as_const(), std::span<const std::size_t>(labels),
                                              Network::outputs, 0.1, gradient.view());
        network.backward(in, out, gradient, {nullptr, in.samples()}, parameter_gradients, threads, space);
    }
};

/// Largest difference of the gradients from those in double, as a share of the largest gradient.
template <class Network>
double gradient_error() {
    tactnet::thread_pool one(1);
    fixture<Network> single(32);
    fixture<typename Network::template with_value_type<double>> exact(32);
    for (std::size_t i = 0; i < Network::parameters; ++i)
        exact.network.learnable_values()[i] = static_cast<double>(single.network.learnable_values()[i]);
    for (std::size_t s = 0; s < 32; ++s)
        for (std::size_t e = 0; e < Network::input_shape.size(); ++e)
            exact.in(s, e) = static_cast<double>(single.in(s, e));
    single.find_gradients(one);
    exact.find_gradients(one);
    double error = 0, largest = 0;
    for (std::size_t i = 0; i < Network::parameters; ++i) {
        const double g = exact.parameter_gradients[i];
        error = std::max(error, std::abs(static_cast<double>(single.parameter_gradients[i]) - g));
        largest = std::max(largest, std::abs(g));
    }
    return error / largest;
}

template <class Network>
bool measure(const char* name, std::size_t samples, double peak, std::size_t rounds) {
    tactnet::thread_pool one(1);
    fixture<Network> f(samples);
    f.infer(one);
    const typename Network::output_batch first = f.out;
    const auto infer = time_rounds(rounds, [&] { f.infer(one); });
    bool same = true;
    for (std::size_t s = 0; s < samples; ++s)
        for (std::size_t o = 0; o < Network::outputs; ++o)
            same = same && first(s, o) == f.out(s, o);
    const auto train = time_rounds(rounds, [&] { f.train(one); });
    const auto rate = [&](double seconds) { return static_cast<double>(samples) / seconds; };
    // A training step multiplies three times: forward, for the inputs (not in the first layer) and for the
    // weights.
    const auto share = [&](const timing& t, double times) {
        return 100 * rate(t.fastest) * times * static_cast<double>(Network::multiply_adds_on_pixels) / peak;
    };
    std::printf("%-12s %6zu %9.0f %9.0f %7.0f%% %9.0f %9.0f %7.0f%%  %s\n", name, samples,
                rate(infer.fastest), rate(infer.median), share(infer, 1), rate(train.fastest),
                rate(train.median), share(train, 3),
                same && std::isfinite(f.loss) ? "same bits" : "DIFFERENT");
    return same && std::isfinite(f.loss);
}

/// The line above the results.
inline void print_table_head(double peak, std::size_t rounds) {
    std::printf("one core, %zu lanes, peak %.1f GFLOP/s; images per second in the fastest and the median of "
                "%zu rounds;\n"
                "shares of the peak in the fastest round, counting taps on real pixels\n\n",
                tactnet::kernels::lanes<float>, 2e-9 * peak, rounds);
    std::printf("%-12s %6s %9s %9s %8s %9s %9s %8s\n", "network", "batch", "infer", "median", "of peak",
                "train", "median", "of peak");
}

template <class Network>
bool checked(const char* name) {
    const double error = gradient_error<Network>();
    std::printf("%-12s gradients differ from double precision by %.1e of the largest\n", name, error);
    return error < 1e-3; // a wrong gradient is off by its own size; single precision by some 1e-5
}

} // namespace benchmark
