#pragma once

// Networks for hard frames, trained briefly on distinguishable frames, so that weights, biases and running
// moments come from training, not from initialisation.

#include <tactnet/networks/batch_passes.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/training/initialise.hpp>
#include <tactnet/training/loss.hpp>
#include <tactnet/training/optimiser.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <deployment/deployed_network.hpp>
#include <limits>
#include <numbers>
#include <span>
#include <string>
#include <vector>

namespace hard_cases {

struct named_frame {
    const char* name;
    std::vector<float> counts;
};

/// Counts that a broken or unusual sensor may give.
inline std::vector<named_frame> hard_frames(tactnet::shape image) {
    const std::size_t size = image.size();
    std::vector<named_frame> frames{{"all zero", std::vector<float>(size, 0.0f)},
                                    {"all 255", std::vector<float>(size, 255.0f)},
                                    {"one tactel", std::vector<float>(size, 0.0f)},
                                    {"checkerboard", std::vector<float>(size)},
                                    {"a negative tactel", std::vector<float>(size, 20.0f)},
                                    {"±1e15", std::vector<float>(size)},
                                    {"±1e30", std::vector<float>(size)}};
    frames[2].counts[size / 2] = 255;
    frames[4].counts[size / 3] = -40;
    for (std::size_t i = 0; i < size; ++i) {
        const bool odd = (i / image.columns + i % image.columns) % 2 == 1;
        frames[3].counts[i] = odd ? 255.0f : 0.0f;
        frames[5].counts[i] = odd ? 1e15f : -1e15f;
        frames[6].counts[i] = odd ? 1e30f : -1e30f;
    }
    return frames;
}

/// A ramp of the smallest numbers there are, 1 to 91 or 1400 times the smallest.
inline std::vector<float> denormal_ramp(tactnet::shape image) {
    std::vector<float> ramp(image.size());
    for (std::size_t i = 0; i < ramp.size(); ++i)
        ramp[i] = static_cast<float>(i + 1) * std::numeric_limits<float>::denorm_min();
    return ramp;
}

/// A value that no frame should have, at the first, a middle and the last tactel.
struct broken_value {
    float value;
    const char* name;
};
inline std::vector<broken_value> broken_values() {
    return {{NAN, "NaN at three places"},
            {INFINITY, "∞ at three places"},
            {-INFINITY, "−∞ at three places"},
            {1e38f, "1e38 at three places"}};
}
inline std::vector<std::vector<float>> broken_frames(tactnet::shape image, float value) {
    std::vector<std::vector<float>> frames;
    for (const std::size_t place : {std::size_t{0}, image.size() / 2, image.size() - 1}) {
        frames.emplace_back(image.size(), 20.0f);
        frames.back()[place] = value;
    }
    return frames;
}

/// A network after a short training, and the mean that is subtracted before it.
template <class Network>
struct trained_subject {
    static constexpr std::size_t classes = Network::outputs, at_once = 32;

    Network net;
    std::vector<float> mean;
    tactnet::thread_pool threads{1};
    typename Network::workspace space;

    explicit trained_subject(std::uint64_t seed) : mean(Network::input_shape.size(), 40.0f) {
        using tactnet::initialise;
        initialise(net, tactnet::he_normal{}, seed);
        train(seed);
        net.prepare(threads, space);
    }
    /// A bar across the image, an angle for each class, pressed at another place and with another force each
    /// time, over what a sensor gives without touch.
    static std::vector<float> touch(std::size_t label, std::uint64_t seed) {
        constexpr tactnet::shape image = Network::input_shape;
        support::numbers draw(seed * 1000 + label);
        const float angle = std::numbers::pi_v<float> * static_cast<float>(label) / classes,
                    across = std::sin(angle), along = std::cos(angle), shift = draw.next(-0.1f, 0.1f),
                    force = draw.next(120, 250);
        std::vector<float> counts(image.size());
        for (std::size_t i = 0; i < counts.size(); ++i) {
            const float y = static_cast<float>(i / image.columns) / image.rows - 0.5f,
                        x = static_cast<float>(i % image.columns) / image.columns - 0.5f;
            const float from_bar = std::abs(x * across - y * along - shift);
            const float pressed = force * std::max(0.0f, 1 - from_bar * 6) + draw.next(0, 12);
            counts[i] = std::nearbyint(std::min(pressed, 255.0f));
        }
        return counts;
    }
    static std::vector<float> shifted(std::vector<float> counts, const std::vector<float>& mean) {
        for (std::size_t i = 0; i < counts.size(); ++i)
            counts[i] -= mean[i];
        return counts;
    }
    /// Logits of a batch with this frame alone.
    std::vector<float> in_batch(const std::vector<float>& counts) {
        typename Network::input_batch in(1);
        typename Network::output_batch out(1);
        in.set(0, tactnet::tensor_view<const float, Network::input_shape>(shifted(counts, mean).data()));
        net.logits(in.as_const(), out.view(), threads, space);
        std::vector<float> logits(Network::outputs);
        for (std::size_t o = 0; o < logits.size(); ++o)
            logits[o] = out(0, o);
        return logits;
    }

private:
    void train(std::uint64_t seed) {
        constexpr std::uint32_t steps = 60;
        typename Network::input_batch in(at_once);
        typename Network::output_batch out(at_once), out_gradient(at_once);
        const auto values = net.learnable_values();
        tactnet::aligned_vector<float> gradients(values.size());
        const tactnet::optimiser rule = tactnet::adamw{};
        const auto decayed = tactnet::detail::decay_mask(rule, Network::describe(), values.size());
        tactnet::optimiser_state<float> state;
        state.resize(values.size());
        std::vector<std::size_t> labels(at_once);
        double first_loss = 0, last_loss = 0;
        for (std::uint32_t step = 0; step < steps; ++step) {
            for (std::size_t s = 0; s < at_once; ++s) {
                labels[s] = (step * at_once + s) % classes;
                in.set(s, tactnet::tensor_view<const float, Network::input_shape>(
                              shifted(touch(labels[s], step * at_once + s), mean).data()));
            }
            net.prepare(threads, space);
            net.forward(in.as_const(), out.view(), threads, space, seed, step);
            last_loss =
                tactnet::softmax_cross_entropy(out.as_const(), labels, classes, 0, out_gradient.view());
            first_loss = step == 0 ? last_loss : first_loss;
            std::fill(gradients.begin(), gradients.end(), 0.0f);
            net.backward(in.as_const(), out.as_const(), out_gradient.as_const(), {nullptr, at_once},
                         gradients, threads, space, seed, step);
            tactnet::optimiser_step<float>(rule, state, 0.01 * (1 - static_cast<double>(step) / steps),
                                           values, gradients, decayed);
        }
        // What hard frames meet is a network that has learnt something.
        INFO("loss ", first_loss, " before the training, ", last_loss, " after it");
        CHECK(last_loss < first_loss / 2);
    }
};

} // namespace hard_cases
