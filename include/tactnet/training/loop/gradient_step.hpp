#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/training/data/sample_batch.hpp>
#include <tactnet/training/loop/trainable.hpp>
#include <tactnet/training/recipe.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// The perturbation of sharpness-aware minimisation (Foret et al., 2021): parameters move along their
/// gradient, the gradient for the step is taken there, and the parameters move back. That gradient is small
/// if the loss is low all around, so training finds wide minima, which generalise better.
class sam_perturbation {
public:
    /// Moves the parameters by `radius` in the direction of their gradient. A zero gradient moves nothing.
    void climb(trainable& network, std::span<const float> gradients, double radius) {
        const std::span<float> values = network.learnable_values();
        const std::span<const float> statistics = network.running_statistics();
        values_.assign(values.begin(), values.end());
        statistics_.assign(statistics.begin(), statistics.end());
        double squares = 0;
        for (const float g : gradients)
            squares += static_cast<double>(g) * static_cast<double>(g);
        if (squares == 0)
            return;
        const auto step = static_cast<float>(radius / std::sqrt(squares));
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] += step * gradients[i];
    }
    /// Restores parameters and statistics, so that each image counts once in the statistics.
    void come_back(trainable& network) const { network.copy_from(values_, statistics_); }

private:
    std::vector<float> values_, statistics_;
};

/// The steps of a training: the gradients of a batch and the step of the optimiser.
class gradient_step {
public:
    /// The network and the threads must outlive this.
    gradient_step(trainable& network, const recipe& how, std::size_t classes, std::uint64_t seed,
                  thread_pool& threads)
        : network_(network),
          how_(how),
          classes_(classes),
          seed_(seed),
          threads_(threads),
          space_(network.make_workspace()),
          in_(network.input_shape().size(), threads),
          out_(network.outputs()),
          out_gradient_(network.outputs()) {
        const std::size_t size = network.learnable_values().size();
        optimiser_.resize(size);
        gradients_.assign(size, 0);
        decayed_ = decay_mask(how.optimiser, network.describe(), size);
    }

    [[nodiscard]] normalised_batch& in() { return in_; }
    [[nodiscard]] const normalised_batch& in() const { return in_; }
    [[nodiscard]] optimiser_state<float>& optimiser() { return optimiser_; }
    [[nodiscard]] const optimiser_state<float>& optimiser() const { return optimiser_; }

    /// The share of the learning rate that an array learns at. All others learn at the whole rate.
    void set_rate_share(const parameter& p, double share) {
        if (rate_shares_.empty())
            rate_shares_.assign(gradients_.size(), 1.0F);
        std::fill_n(rate_shares_.begin() + static_cast<std::ptrdiff_t>(p.offset), p.size,
                    static_cast<float>(share));
    }

    /// One step with the batch in `in()`. Returns its mean loss before the step.
    double run(std::span<const std::size_t> labels, double rate) {
        const double loss = find_gradients(labels);
        if (how_.sharpness_radius > 0) {
            perturbation_.climb(network_, gradients_, how_.sharpness_radius);
            find_gradients(labels);
            perturbation_.come_back(network_);
        }
        optimiser_step<float>(how_.optimiser, optimiser_, rate, network_.learnable_values(), gradients_,
                              decayed_, rate_shares_);
        return loss;
    }

    /// Sets the running statistics of a network of the same type from the chosen samples as they are: the
    /// mean over batches of them, weighted by their samples. Augmented images would not do: shifted and
    /// rotated ones have empty corners, and other moments than the images to recognise.
    void remeasure_statistics(trainable& network, const labelled_samples& samples,
                              std::span<const std::size_t> chosen) {
        const std::size_t most = how_.batch == 0 ? chosen.size() : std::min(how_.batch, chosen.size());
        const std::size_t batches = ceil_div(chosen.size(), most);
        const double momentum = network.momentum();
        network.prepare(threads_, *space_);
        for (std::size_t batch = 0; batch < batches; ++batch) {
            const std::size_t first = chosen.size() * batch / batches,
                              last = chosen.size() * (batch + 1) / batches;
            network.momentum() = static_cast<double>(last - first) / static_cast<double>(last);
            in_.fill(last - first, [&](std::size_t i, std::span<float> sample) {
                samples.copy(chosen[first + i], sample);
            });
            out_.resize(last - first);
            network.forward(in_.samples(), out_, threads_, *space_, seed_,
                            static_cast<std::uint32_t>(optimiser_.steps + batch));
        }
        network.momentum() = momentum;
    }

private:
    /// Computes the gradients of the batch at the present parameters; returns its mean loss.
    double find_gradients(std::span<const std::size_t> labels) {
        const auto step = static_cast<std::uint32_t>(optimiser_.steps);
        out_.resize(labels.size()), out_gradient_.resize(labels.size());
        network_.prepare(threads_, *space_);
        network_.forward(in_.samples(), out_, threads_, *space_, seed_, step);
        const double loss =
            softmax_cross_entropy<float>({labels.size(), out_.size(), sample_batch::lanes}, out_.data(),
                                         labels, classes_, how_.label_smoothing, out_gradient_.data());
        network_.backward(in_.samples(), out_, out_gradient_, gradients_, threads_, *space_, seed_, step);
        return loss;
    }

    trainable& network_;
    recipe how_;
    std::size_t classes_;
    std::uint64_t seed_;
    thread_pool& threads_;
    optimiser_state<float> optimiser_;
    aligned_vector<float> gradients_, decayed_;
    aligned_vector<float> rate_shares_; ///< empty if all learn at the same rate
    sam_perturbation perturbation_;
    std::unique_ptr<trainable::workspace> space_;
    normalised_batch in_;
    sample_batch out_, out_gradient_;
};

}}} // namespace tactnet::detail
