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

    /// Starts from the parameters and statistics of another network, for example one trained on simulated
    /// images, in place of random ones. Throws std::logic_error after the first epoch.
    void start_from(const Network& other) {
        loop_.start_from(other.learnable_values(), other.running_statistics(), other.momentum);
    }

    /// Trains for one epoch, and validates when due. Throws training_diverged if a loss, a parameter or the
    /// square of a gradient is not finite. `latest` and `best` are then as before the epoch, and the training
    /// cannot continue.
    const epoch_report& run_epoch() { return loop_.run_epoch(); }

    /// Calls visit(name, span of float) for each array that a resumed training needs. To resume, write to
    /// them, then call `restore`.
    template <class Visit>
    void for_each_state(Visit&& visit) {
        loop_.for_each_state(std::forward<Visit>(visit));
    }
    /// The numbers besides the arrays.
    [[nodiscard]] std::vector<double> progress() const { return loop_.progress(); }
    /// Throws std::invalid_argument, and changes nothing, if no training with this recipe has these numbers.
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
