#pragma once

#include <tactnet/training/loop.hpp>
#include <tactnet/training/loop/trainable_network.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// A training of a network of a known type; training_loop is for any type.
template <class Network>
class trainer {
public:
    static constexpr shape input = Network::input_shape;

    /// The values of the samples must outlive the trainer.
    trainer(const recipe& how, const labelled_samples& samples, data_split split, std::uint64_t seed,
            thread_pool& threads)
        : loop_(std::make_unique<trainable_network<Network>>(), how, samples, std::move(split), seed,
                threads) {
        std::copy(loop_.mean().begin(), loop_.mean().end(), normalise_.mean.begin());
        normalise_.scale = loop_.scale();
    }

    [[nodiscard]] bool finished() const { return loop_.finished(); }
    [[nodiscard]] const std::vector<epoch_report>& history() const { return loop_.history(); }
    [[nodiscard]] std::size_t samples_per_epoch() const { return loop_.samples_per_epoch(); }
    /// The network with the smallest validation loss so far, smoothed over a few validations; the latest if
    /// there are no validation images.
    [[nodiscard]] const Network& best() const { return network_of(loop_.best()); }
    [[nodiscard]] const Network& latest() const { return network_of(loop_.latest()); }
    [[nodiscard]] const normalisation<input>& input_normalisation() const { return normalise_; }
    [[nodiscard]] const data_split& split() const { return loop_.split(); }

    /// As training_loop::start_from.
    void start_from(const Network& other) {
        loop_.start_from(other.learnable_values(), other.running_statistics(), other.momentum);
    }

    /// As training_loop::run_epoch: throws training_diverged.
    const epoch_report& run_epoch() { return loop_.run_epoch(); }

    // To resume a training, as in training_loop.
    template <class Visit>
    void for_each_state(Visit&& visit) {
        loop_.for_each_state(std::forward<Visit>(visit));
    }
    [[nodiscard]] std::vector<double> progress() const { return loop_.progress(); }
    void restore(std::span<const double> numbers) { loop_.restore(numbers); }

private:
    static const Network& network_of(const trainable& network) {
        return static_cast<const trainable_network<Network>&>(network).network();
    }

    training_loop loop_;
    normalisation<input> normalise_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
