#pragma once

#include <tactnet/networks/model.hpp>
#include <tactnet/training/loop.hpp>
#include <tactnet/training/loop/trainable.hpp>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// A training of a network of a known type; training_loop is for any type.
template <class Network>
class trainer : public training_loop {
public:
    static constexpr shape input = Network::input_shape;

    /// The values of the samples must outlive the trainer.
    trainer(const recipe& how, const labelled_samples& samples, data_split split, std::uint64_t seed,
            thread_pool& threads)
        : training_loop(std::make_unique<trainable_network<Network>>(), how, samples, std::move(split), seed,
                        threads) {
        std::copy(mean().begin(), mean().end(), normalise_.mean.begin());
        normalise_.scale = scale();
        normalise_.function = function();
    }

    /// The network with the smallest validation loss so far, smoothed over a few validations; the latest if
    /// there are no validation images.
    [[nodiscard]] const Network& best() const { return network_of(training_loop::best()); }
    [[nodiscard]] const Network& latest() const { return network_of(training_loop::latest()); }
    [[nodiscard]] const normalisation<input>& input_normalisation() const { return normalise_; }

    /// The best network with all that it takes to deploy and save it. `classes` are the names of the samples'
    /// classes, in order, or none yet. Throws std::invalid_argument for names of some of them, or of more.
    [[nodiscard]] model<Network> trained(std::vector<std::string> classes) const {
        if (!classes.empty() && classes.size() != training_loop::classes())
            detail::throw_invalid_argument({"trained: expected the names of all ", training_loop::classes(),
                                            " classes of the samples, or none, found ", classes.size()});
        return {best(), normalise_, std::move(classes), 1, reflections()};
    }

    /// As training_loop::start_from.
    void start_from(const Network& other) {
        training_loop::start_from(other.learnable_values(), other.running_statistics(), other.momentum);
    }

private:
    static const Network& network_of(const trainable& network) {
        return static_cast<const trainable_network<Network>&>(network).network();
    }

    normalisation<input> normalise_;
};

}} // namespace tactnet
