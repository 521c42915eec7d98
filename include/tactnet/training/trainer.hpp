#pragma once

#include <tactnet/training/divergence.hpp>
#include <tactnet/training/early_stopping.hpp>
#include <tactnet/training/epoch_images.hpp>
#include <tactnet/training/evaluate.hpp>
#include <tactnet/training/initialise.hpp>
#include <tactnet/training/labelled_images.hpp>
#include <tactnet/training/loss.hpp>
#include <tactnet/training/optimiser.hpp>
#include <tactnet/training/progress.hpp>
#include <tactnet/training/recipe.hpp>
#include <tactnet/training/schedule.hpp>
#include <tactnet/training/split.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// One for weights, zero for all else that is learnt, up to a whole vector: what weight decay applies to.
inline aligned_vector<float> decay_mask(const std::vector<parameter>& parameters, std::size_t size) {
    aligned_vector<float> mask(size, 0.0f);
    for (const parameter& p : parameters)
        if (p.what == role::weight)
            std::fill_n(mask.begin() + static_cast<std::ptrdiff_t>(p.offset), p.size, 1.0f);
    return mask;
}

/// Moves a running mean towards the latest values, by their share.
inline void blend(std::span<float> mean, std::span<const float> latest, float share) {
    for (std::size_t i = 0; i < mean.size(); ++i)
        mean[i] += share * (latest[i] - mean[i]);
}

} // namespace detail

/// A training in progress, epoch by epoch. Every random number is a function of (seed, epoch, image), all
/// sums have a fixed order: the same seed is bit-exact on any number of threads, in one go or in
/// several (see for_each_state).
template <class Network>
class trainer {
public:
    static constexpr shape input = Network::input_shape;

    /// The images must outlive the trainer.
    trainer(const recipe& how, const labelled_images& images, data_split split, std::uint64_t seed,
            thread_pool& threads)
        : how_(checked(how, images, split)),
          images_(images),
          split_(std::move(split)),
          seed_(seed),
          threads_(threads),
          shown_(how, images, split_.training, seed, threads),
          stopping_(how.patience) {
        network_.epsilon = how.epsilon;
        initialise(network_, how.initialisation, seed);
        if (how.input == input_rule::subtract_mean)
            normalise_.mean = normalisation<input>::mean_of(images.pixels, split_.training);
        else
            normalise_.scale = 1.0f / 255;
        optimiser_.resize(network_.learnable_values().size());
        gradients_.assign(network_.learnable_values().size(), 0);
        decayed_ = detail::decay_mask(Network::describe(), gradients_.size());
        averaged_ = best_ = network_;
    }

    [[nodiscard]] bool finished() const { return progress_.stopped || history().size() >= how_.epochs; }
    [[nodiscard]] const std::vector<epoch_report>& history() const { return progress_.history; }
    [[nodiscard]] std::size_t images_per_epoch() const { return shown_.size(); }
    /// The network with the smallest validation loss so far, smoothed over a few validations; the latest
    /// where there are no validation images.
    [[nodiscard]] const Network& best() const { return split_.validation.empty() ? candidate() : best_; }
    [[nodiscard]] const Network& latest() const { return candidate(); }
    [[nodiscard]] const normalisation<input>& input_normalisation() const { return normalise_; }
    [[nodiscard]] const data_split& split() const { return split_; }

    /// Begins with the parameters and statistics of another network, for example one that was trained on
    /// simulated images, in place of random ones. Throws std::logic_error after the first epoch.
    void start_from(const Network& other) {
        if (!history().empty())
            throw std::logic_error("trainer: a training that has begun cannot start from another network");
        const double epsilon = network_.epsilon;
        network_ = other;
        network_.epsilon = epsilon;
        averaged_ = best_ = network_;
    }

    /// Trains for one epoch, and validates when due. Throws training_diverged, also when it is the last step
    /// that leaves numbers which are not finite, or when the validation loss is not.
    const epoch_report& run_epoch() {
        const std::size_t epoch = history().size();
        const std::vector<std::size_t> order = shown_.order(epoch);
        epoch_report report{.epoch = epoch + 1};
        for (std::size_t step = 0; step < shown_.steps(); ++step) {
            const double when =
                static_cast<double>(epoch) + static_cast<double>(step) / static_cast<double>(shown_.steps());
            report.rate = rate_at(how_.schedule, how_.rate, when, static_cast<double>(how_.epochs));
            const std::span<const std::size_t> places = shown_.batch(step, order);
            const double loss = take(places, epoch, report.rate);
            detail::check_loss(loss, report, "step " + std::to_string(step + 1));
            report.loss += loss * static_cast<double>(places.size()) / static_cast<double>(order.size());
        }
        detail::check_parameters(network_.learnable_values(), report);
        detail::check_parameters(network_.running_statistics(), report);
        if ((epoch + 1) % how_.validate_every == 0 || epoch + 1 == how_.epochs) {
            if (how_.remeasure_statistics)
                remeasure_statistics(how_.averaging > 0 ? averaged_ : network_);
            if (!split_.validation.empty())
                validate(report);
        }
        progress_.history.push_back(report);
        return history().back();
    }

    /// visit(name, std::span<float>) for all that a resumed training needs; after writing to them,
    /// `restore`.
    template <class Visit>
    void for_each_state(Visit&& visit) {
        visit("values", network_.learnable_values());
        visit("statistics", network_.running_statistics());
        visit("optimiser.first", std::span<float>(optimiser_.first));
        visit("optimiser.second", std::span<float>(optimiser_.second));
        visit("averaged.values", averaged_.learnable_values());
        visit("averaged.statistics", averaged_.running_statistics());
        visit("best.values", best_.learnable_values());
        visit("best.statistics", best_.running_statistics());
    }
    /// The numbers beside the arrays.
    [[nodiscard]] std::vector<double> progress() const {
        training_progress p = progress_;
        p.steps = optimiser_.steps;
        p.smallest_loss = stopping_.smallest(), p.waited = stopping_.waited();
        return p.numbers();
    }
    /// Throws std::invalid_argument, and changes nothing, for numbers that no training with this recipe has.
    void restore(std::span<const double> numbers) {
        progress_ = training_progress::from(numbers, how_.epochs, shown_.steps());
        optimiser_.steps = progress_.steps;
        stopping_.restore(progress_.smallest_loss, progress_.waited);
    }

private:
    [[nodiscard]] const Network& candidate() const { return how_.averaging > 0 ? averaged_ : network_; }

    static const recipe& checked(const recipe& how, const labelled_images& images, const data_split& split) {
        check_images<Network>(images);
        if (how.validate_every == 0)
            throw std::invalid_argument("trainer: expected a validation every 1 or more epochs, found 0");
        if (split.training.empty())
            throw std::invalid_argument("trainer: the training part of the split holds no image");
        return how;
    }

    void make_inputs(std::span<const std::size_t> places, std::size_t epoch) {
        in_.resize(places.size()), out_.resize(places.size());
        threads_.for_each(places.size(), [&](std::size_t i) {
            tensor<float, input> image;
            shown_.make(places[i], epoch, image);
            normalise_.apply(image);
            in_.set(i, image);
        });
    }

    /// One step; returns the mean loss before it.
    double take(std::span<const std::size_t> places, std::size_t epoch, double rate) {
        const std::size_t count = places.size();
        make_inputs(places, epoch);
        out_gradient_.resize(count);
        std::vector<std::size_t> labels(count);
        for (std::size_t i = 0; i < count; ++i)
            labels[i] = shown_.label(places[i]);

        const auto step = static_cast<std::uint32_t>(optimiser_.steps);
        network_.prepare(threads_, space_);
        network_.forward(threads_, space_, in_, out_, seed_, step);
        const double loss =
            softmax_cross_entropy(out_.as_const(), std::span<const std::size_t>(labels), images_.classes,
                                  how_.label_smoothing, out_gradient_.view());
        network_.backward(threads_, space_, in_, out_, out_gradient_, {nullptr, count}, gradients_, seed_,
                          step);
        take_step<float>(how_.optimiser, optimiser_, rate, network_.learnable_values(), gradients_, decayed_);
        if (how_.averaging > 0)
            average();
        return loss;
    }

    void average() {
        const auto steps = static_cast<double>(optimiser_.steps);
        const auto past = static_cast<float>(std::min(how_.averaging, (1 + steps) / (10 + steps)));
        detail::blend(averaged_.learnable_values(), network_.learnable_values(), 1 - past);
        detail::blend(averaged_.running_statistics(), network_.running_statistics(), 1 - past);
    }

    /// Statistics of the network that is to be validated, anew from the training images as they are: the mean
    /// of what batches of them give, each counted by its images. Not from the images as they were varied:
    /// shifted and turned ones have empty corners, and other moments than those that are to be recognised.
    void remeasure_statistics(Network& network) {
        const std::span<const std::size_t> images = split_.training;
        const std::size_t most = how_.batch == 0 ? images.size() : std::min(how_.batch, images.size());
        const std::size_t batches = (images.size() + most - 1) / most;
        const double momentum = network.momentum;
        network.prepare(threads_, space_);
        for (std::size_t batch = 0; batch < batches; ++batch) {
            const std::size_t first = images.size() * batch / batches,
                              last = images.size() * (batch + 1) / batches;
            network.momentum = static_cast<double>(last - first) / static_cast<double>(last);
            in_.resize(last - first), out_.resize(last - first);
            threads_.for_each(last - first, [&](std::size_t i) {
                in_.set(i, normalise_(images_.template image<input>(images[first + i])));
            });
            network.forward(threads_, space_, in_, out_, seed_,
                            static_cast<std::uint32_t>(optimiser_.steps + batch));
        }
        network.momentum = momentum;
    }

    void validate(epoch_report& report) {
        const evaluation result = evaluate(candidate(), normalise_, images_, split_.validation, threads_);
        detail::check_loss(result.loss, report, "validation");
        report.validation_loss = result.loss;
        report.validation_accuracy = result.confusion.accuracy();
        if (progress_.validated(result.loss))
            best_ = candidate();
        progress_.stopped = stopping_.check(result.loss);
    }

    recipe how_;
    labelled_images images_;
    data_split split_;
    std::uint64_t seed_;
    thread_pool& threads_;
    epoch_images<input> shown_;
    early_stopping stopping_;
    normalisation<input> normalise_;
    Network network_, averaged_, best_;
    optimiser_state<float> optimiser_;
    aligned_vector<float> gradients_, decayed_;
    training_progress progress_;
    typename Network::workspace space_;
    typename Network::input_batch in_;
    typename Network::output_batch out_, out_gradient_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
