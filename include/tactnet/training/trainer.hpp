#pragma once

#include <tactnet/image/augmentation.hpp>
#include <tactnet/training/early_stopping.hpp>
#include <tactnet/training/evaluate.hpp>
#include <tactnet/training/recipe.hpp>
#include <tactnet/training/split.hpp>

#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tactnet::inline TACTNET_ARCH {

/// The loss is no longer a finite number.
struct training_diverged : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// One epoch of a training.
struct epoch_report {
    std::size_t epoch = 0;                                                 ///< counted from 1
    double rate = 0;                                                       ///< learning rate of its last step
    double loss = 0;                                                       ///< mean training loss
    double validation_loss = std::numeric_limits<double>::quiet_NaN();     ///< NaN where none was due
    double validation_accuracy = std::numeric_limits<double>::quiet_NaN(); ///< NaN where none was due
};

/// A training in progress, epoch by epoch. Every random number is a function of (seed, epoch, image), all
/// sums have a fixed order: the same seed gives the same bits on any number of threads, in one go or in
/// several (see for_each_state).
template <class Network>
class trainer {
public:
    static constexpr shape input = Network::input_shape;

    /// The images must outlive the trainer.
    trainer(const recipe& how, const labelled_images& images, data_split split, std::uint64_t seed,
            thread_pool& threads)
        : how_(how),
          images_(images),
          split_(std::move(split)),
          seed_(seed),
          threads_(threads),
          stopping_(how.patience) {
        check_images<Network>(images);
        if (how.validate_every == 0)
            throw std::invalid_argument("trainer: expected a validation every 1 or more epochs, found 0");
        if (split_.training.empty())
            throw std::invalid_argument("trainer: the training part of the split holds no image");
        network_.epsilon = how.epsilon;
        initialise(network_, how.initialisation, seed);
        if (how.input == input_rule::subtract_mean)
            normalise_.mean = normalisation<input>::mean_of(images.pixels, split_.training);
        else
            normalise_.scale = 1.0f / 255;
        optimiser_.resize(network_.learnable_values().size());
        gradients_.assign(network_.learnable_values().size(), 0);
        decayed_.assign(gradients_.size(), 0);
        for (const parameter& p : Network::describe())
            if (p.what == role::weight)
                std::fill_n(decayed_.begin() + static_cast<std::ptrdiff_t>(p.offset), p.size, 1.0f);
        averaged_ = best_ = network_;
        if (how.augmentation == augmentation_rule::sixfold)
            make_sixfold();
    }

    [[nodiscard]] bool finished() const { return stopped_ || history_.size() >= how_.epochs; }
    [[nodiscard]] const std::vector<epoch_report>& history() const { return history_; }
    [[nodiscard]] std::size_t images_per_epoch() const {
        return split_.training.size() * (how_.augmentation == augmentation_rule::sixfold ? 6 : 1);
    }
    /// The network with the smallest validation loss so far, smoothed over a few validations; the latest
    /// where there are no validation images.
    [[nodiscard]] const Network& best() const { return split_.validation.empty() ? candidate() : best_; }
    [[nodiscard]] const Network& latest() const { return candidate(); }
    [[nodiscard]] const normalisation<input>& input_normalisation() const { return normalise_; }
    [[nodiscard]] const data_split& split() const { return split_; }

    /// Trains for one epoch, and validates when due. Throws training_diverged.
    const epoch_report& run_epoch() {
        const std::size_t epoch = history_.size(), count = images_per_epoch();
        const std::size_t batch = how_.batch == 0 ? split_.training.size() : std::min(how_.batch, count);
        const std::size_t steps = (count + batch - 1) / batch;
        std::vector<std::size_t> order(count);
        std::iota(order.begin(), order.end(), std::size_t{0});
        if (steps > 1)
            random_stream(seed_, draw::order, static_cast<std::uint32_t>(epoch)).shuffle(order);

        epoch_report report{.epoch = epoch + 1};
        for (std::size_t step = 0; step < steps; ++step) {
            // Batches of equal size, so that none is left with a handful of images for its batch norms.
            const std::size_t first = count * step / steps, last = count * (step + 1) / steps;
            const double when =
                static_cast<double>(epoch) + static_cast<double>(step) / static_cast<double>(steps);
            report.rate = rate_at(how_.schedule, how_.rate, when, static_cast<double>(how_.epochs));
            const double loss = take(std::span(order).subspan(first, last - first), epoch, report.rate);
            if (!std::isfinite(loss))
                throw training_diverged(
                    "training diverged in epoch " + std::to_string(epoch + 1) + ", step " +
                    std::to_string(step + 1) + ": expected a finite loss, found " + std::to_string(loss) +
                    "; lower the learning rate (now " + std::to_string(report.rate) + ")");
            report.loss += loss * static_cast<double>(last - first) / static_cast<double>(count);
        }
        if (!split_.validation.empty() &&
            ((epoch + 1) % how_.validate_every == 0 || epoch + 1 == how_.epochs))
            validate(report);
        history_.push_back(report);
        return history_.back();
    }

    /// visit(name, span of float or double) for all that a resumed training needs; after writing to them,
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
        std::vector<double> p{static_cast<double>(optimiser_.steps),
                              best_loss_,
                              smoothed_loss_,
                              stopping_.smallest(),
                              static_cast<double>(stopping_.waited()),
                              stopped_ ? 1.0 : 0.0};
        for (const epoch_report& e : history_)
            p.insert(p.end(), {e.rate, e.loss, e.validation_loss, e.validation_accuracy});
        return p;
    }
    void restore(std::span<const double> p) {
        if (p.size() < 6 || (p.size() - 6) % 4 != 0)
            throw std::invalid_argument(
                "trainer: the progress of a training has 6 numbers and 4 for each epoch");
        optimiser_.steps = static_cast<std::uint64_t>(p[0]);
        best_loss_ = p[1];
        smoothed_loss_ = p[2];
        stopping_.restore(p[3], static_cast<std::size_t>(p[4]));
        stopped_ = p[5] != 0;
        history_.clear();
        for (std::size_t i = 6; i < p.size(); i += 4)
            history_.push_back({history_.size() + 1, p[i], p[i + 1], p[i + 2], p[i + 3]});
    }

private:
    [[nodiscard]] const Network& candidate() const { return how_.averaging > 0 ? averaged_ : network_; }

    void make_sixfold() {
        sixfold_.resize(images_per_epoch());
        threads_.for_each(sixfold_.size(), [&](std::size_t i) {
            const std::size_t image = split_.training[i / 6];
            random_stream random(seed_, draw::augmentation, static_cast<std::uint32_t>(i % 6),
                                 static_cast<std::uint32_t>(image));
            const image_transform t =
                i % 6 == 0 ? image_transform{} : image_transform::draw(how_.ranges, random);
            transform_image<input>(t, images_.template image<input>(image), sixfold_[i]);
        });
    }

    /// The image at one place of the epoch's order, augmented and normalised.
    void make_input(std::size_t place, std::size_t epoch, tensor<float, input>& to) const {
        if (how_.augmentation == augmentation_rule::sixfold) {
            to = sixfold_[place];
        } else {
            const std::size_t image = split_.training[place];
            image_transform t;
            if (how_.augmentation == augmentation_rule::each_epoch) {
                random_stream random(seed_, draw::augmentation, static_cast<std::uint32_t>(epoch),
                                     static_cast<std::uint32_t>(image));
                t = image_transform::draw(how_.ranges, random);
            }
            transform_image<input>(t, images_.template image<input>(image), to);
        }
        normalise_.apply(to);
    }

    /// One step; returns the mean loss before it.
    double take(std::span<const std::size_t> places, std::size_t epoch, double rate) {
        const std::size_t count = places.size();
        in_.resize(count), out_.resize(count), out_gradient_.resize(count);
        std::vector<std::size_t> labels(count);
        threads_.for_each(count, [&](std::size_t i) {
            tensor<float, input> image;
            make_input(places[i], epoch, image);
            in_.set(i, image);
        });
        const std::size_t copies = how_.augmentation == augmentation_rule::sixfold ? 6 : 1;
        for (std::size_t i = 0; i < count; ++i)
            labels[i] = images_.labels[split_.training[places[i] / copies]];

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
        const auto blend = [&](std::span<float> to, std::span<const float> from) {
            for (std::size_t i = 0; i < to.size(); ++i)
                to[i] += (1 - past) * (from[i] - to[i]);
        };
        blend(averaged_.learnable_values(), network_.learnable_values());
        blend(averaged_.running_statistics(), network_.running_statistics());
    }

    void remeasure_statistics() {
        const double momentum = std::exchange(network_.momentum, 1.0);
        network_.prepare(threads_, space_);
        network_.forward(threads_, space_, in_, out_, seed_, static_cast<std::uint32_t>(optimiser_.steps));
        network_.momentum = momentum;
    }

    void validate(epoch_report& report) {
        if (how_.remeasure_statistics)
            remeasure_statistics();
        const evaluation result = evaluate(candidate(), normalise_, images_, split_.validation, threads_);
        report.validation_loss = result.loss;
        report.validation_accuracy = result.confusion.accuracy();
        // Smoothed, for a few images tell good from better only by luck: one lucky epoch long before the end
        // would otherwise be kept.
        smoothed_loss_ =
            std::isfinite(smoothed_loss_) ? 0.8 * smoothed_loss_ + 0.2 * result.loss : result.loss;
        if (smoothed_loss_ <= best_loss_) {
            best_ = candidate();
            best_loss_ = smoothed_loss_;
        }
        stopped_ = stopping_.check(result.loss);
    }

    recipe how_;
    labelled_images images_;
    data_split split_;
    std::uint64_t seed_;
    thread_pool& threads_;
    early_stopping stopping_;
    normalisation<input> normalise_;
    Network network_, averaged_, best_;
    optimiser_state<float> optimiser_;
    aligned_vector<float> gradients_, decayed_;
    std::vector<tensor<float, input>> sixfold_;
    std::vector<epoch_report> history_;
    double best_loss_ = std::numeric_limits<double>::infinity(), smoothed_loss_ = best_loss_;
    bool stopped_ = false;
    typename Network::workspace space_;
    typename Network::input_batch in_;
    typename Network::output_batch out_, out_gradient_;
};

} // namespace tactnet
