#pragma once

#include <tactnet/text/message.hpp>
#include <tactnet/training/data/split.hpp>
#include <tactnet/training/loop/epoch_samples.hpp>
#include <tactnet/training/loop/gradient_step.hpp>
#include <tactnet/training/loop/progress.hpp>
#include <tactnet/training/loop/trainable.hpp>
#include <tactnet/training/recipe.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// Moves a running mean towards the latest values by their share.
inline void blend(std::span<float> mean, std::span<const float> latest, float share) {
    for (std::size_t i = 0; i < mean.size(); ++i)
        mean[i] += share * (latest[i] - mean[i]);
}

/// Throws unless each array has values of the right number, or none.
inline void check_trunk(std::span<const parameter> parameters, std::span<const std::vector<float>> arrays) {
    const auto refuse = [](text_parts what, std::size_t expected, std::size_t found) {
        throw_invalid_argument({"trainer: expected ", expected, " ", joined(what), ", found ", found});
    };
    if (arrays.size() != parameters.size())
        refuse({"arrays"}, parameters.size(), arrays.size());
    for (std::size_t i = 0; i < arrays.size(); ++i)
        if (!arrays[i].empty() && arrays[i].size() != parameters[i].size)
            refuse({"numbers in ", parameters[i].name}, parameters[i].size, arrays[i].size());
}

} // namespace detail

/// A training in progress, epoch by epoch, of a network of any type; `trainer` is for a known type. Every
/// random number is a function of (seed, epoch, sample), and all sums have a fixed order: the same seed gives
/// the same bits on any number of threads, without a break or resumed (see for_each_state).
class training_loop {
public:
    /// The values of the samples must outlive the training. Features enter the network unchanged, whatever
    /// the recipe says about images.
    training_loop(std::unique_ptr<trainable> network, const recipe& how, const labelled_samples& samples,
                  data_split split, std::uint64_t seed, thread_pool& threads)
        : network_(std::move(network)),
          how_(checked(how, samples, split)),
          samples_(samples),
          split_(std::move(split)),
          threads_(threads),
          shown_(how, *network_, samples, split_.training, seed, threads),
          stopping_{how.patience},
          step_(*network_, how, samples.classes(), seed, threads) {
        detail::check_batches(*network_, shown_);
        network_->epsilon() = how.epsilon;
        if (samples_.are_images()) {
            if (how.input != input_rule::scale && network_->needs_counts())
                detail::throw_invalid_argument(
                    {"trainer: expected input_rule::scale for a network that takes counts, found "
                     "input_rule::",
                     how.input == input_rule::counts ? "counts" : "subtract_mean"});
            step_.in().compress(how.function);
            if (how.input == input_rule::subtract_mean)
                step_.in().subtract_mean(samples_.pixels(), split_.training);
            else if (how.input == input_rule::scale)
                step_.in().scale_by(1.0f / 255);
        }
        const std::vector<parameter> parameters = network_->describe();
        std::uint32_t index = 0;
        for (const parameter& p : parameters)
            detail::initialise(p, network_->values_of(p), how.initialisation, seed, index);
        averaged_ = network_->copy();
        best_ = network_->copy();
        kept_ = network_->copy();
    }

    [[nodiscard]] bool finished() const { return progress_.stopped || history().size() >= how_.epochs; }
    [[nodiscard]] const std::vector<epoch_report>& history() const { return progress_.history; }
    [[nodiscard]] std::size_t samples_per_epoch() const { return shown_.size(); }
    [[nodiscard]] std::size_t classes() const { return samples_.classes(); }
    /// The network with the smallest validation loss so far, smoothed over a few validations. The latest if
    /// there are no validation images, or if the recipe keeps the last.
    [[nodiscard]] const trainable& best() const {
        return split_.validation.empty() || how_.keeps_last ? candidate() : *best_;
    }
    [[nodiscard]] const trainable& latest() const { return candidate(); }
    /// Inputs are (number − mean) × scale, of compressed counts or of features.
    [[nodiscard]] std::span<const float> mean() const { return step_.in().mean(); }
    [[nodiscard]] float scale() const { return step_.in().scale(); }
    /// Those of recipe::learnt_reflections.
    [[nodiscard]] reflection_rule reflections() const { return how_.learnt_reflections(); }
    [[nodiscard]] const input_function& function() const { return step_.in().function(); }
    [[nodiscard]] const data_split& split() const { return split_; }

    /// Starts from the parameters and statistics of another network, for example one trained on simulated
    /// images, in place of random ones. Throws std::logic_error after the first epoch.
    void start_from(std::span<const float> values, std::span<const float> statistics,
                    std::optional<double> momentum = std::nullopt) {
        check_not_begun();
        for (trainable* const each : {network_.get(), averaged_.get(), best_.get()}) {
            each->copy_from(values, statistics);
            each->momentum() = momentum.value_or(each->momentum());
        }
    }

    /// Starts from arrays of a network that was trained on something else. `arrays` holds the values of each
    /// array of `describe`, in its order, or none for an array that keeps its random values. The given arrays
    /// learn at the recipe's share of the rate. Throws std::logic_error after the first epoch, and
    /// std::invalid_argument for arrays of other sizes.
    void start_from_trunk(std::span<const std::vector<float>> arrays) {
        check_not_begun();
        const std::vector<parameter> parameters = network_->describe();
        detail::check_trunk(parameters, arrays);
        for (std::size_t i = 0; i < arrays.size(); ++i) {
            if (arrays[i].empty())
                continue;
            const parameter& p = parameters[i];
            for (trainable* const each : {network_.get(), averaged_.get(), best_.get()})
                std::copy(arrays[i].begin(), arrays[i].end(), each->values_of(p).begin());
            if (learnable(p.role))
                step_.set_rate_share(p, how_.pretrained_rate);
        }
    }

    /// Trains for one epoch, and validates when due. Throws training_diverged if a loss, a parameter or the
    /// square of a gradient is not finite. `latest` and `best` are then as before the epoch, and the training
    /// cannot continue.
    const epoch_report& run_epoch() {
        kept_->copy_from(candidate());
        try {
            progress_.history.push_back(trained_epoch());
        } catch (const training_diverged&) {
            candidate().copy_from(*kept_);
            throw;
        }
        return history().back();
    }

    /// Calls visit(name, span of float) for each array that a resumed training needs. To resume, write to
    /// them, then call `restore`.
    template <class Visit>
    void for_each_state(Visit&& visit) {
        visit("values", network_->learnable_values());
        visit("statistics", network_->running_statistics());
        visit("optimiser.first", std::span<float>(step_.optimiser().first));
        visit("optimiser.second", std::span<float>(step_.optimiser().second));
        visit("averaged.values", averaged_->learnable_values());
        visit("averaged.statistics", averaged_->running_statistics());
        visit("best.values", best_->learnable_values());
        visit("best.statistics", best_->running_statistics());
    }
    /// Which elements of such an array are squares or variances, never below zero; further ones are none.
    [[nodiscard]] std::vector<bool> squares(std::string_view array) {
        std::vector<bool> found(array == "optimiser.second" ? step_.optimiser().second.size() : 0, true);
        if (array.ends_with("statistics"))
            for (const parameter& p : network_->describe())
                if (!learnable(p.role)) {
                    found.resize(std::max(found.size(), p.offset + p.size));
                    std::fill_n(found.begin() + static_cast<std::ptrdiff_t>(p.offset), p.size,
                                p.role == parameter_role::running_variance);
                }
        return found;
    }
    /// The numbers besides the arrays.
    [[nodiscard]] std::vector<double> progress() const {
        training_progress p = progress_;
        p.steps = step_.optimiser().steps;
        p.smallest_loss = stopping_.smallest, p.waited = stopping_.waited;
        return p.numbers();
    }
    /// Throws std::invalid_argument, and changes nothing, if no training with this recipe has these numbers.
    void restore(std::span<const double> numbers) {
        progress_ = training_progress::from(numbers, how_.epochs, shown_.steps());
        step_.optimiser().steps = progress_.steps;
        stopping_.smallest = progress_.smallest_loss, stopping_.waited = progress_.waited;
    }

private:
    void check_not_begun() const {
        if (!history().empty())
            throw std::logic_error("trainer: a training that has begun cannot start from another network");
    }
    [[nodiscard]] trainable& candidate() const { return how_.averaging > 0 ? *averaged_ : *network_; }

    const recipe& checked(const recipe& how, const labelled_samples& samples, const data_split& split) const {
        samples.check(network_->input_shape(), network_->outputs());
        samples.check_finite(network_->input_shape());
        samples.check_indices(split.training);
        samples.check_classes(split.validation);
        samples.check_classes(split.test);
        check_split(split, samples.labels());
        how.check();
        detail::check_partners("trainer", how.reflections, samples.classes());
        if (split.training.empty())
            throw std::invalid_argument("trainer: the training part of the split holds no sample");
        return how;
    }

    epoch_report trained_epoch() {
        const std::size_t epoch = history().size();
        const std::vector<std::size_t> order = shown_.order(epoch);
        epoch_report report{.epoch = epoch + 1};
        for (std::size_t step = 0; step < shown_.steps(); ++step) {
            const double when =
                static_cast<double>(epoch) + static_cast<double>(step) / static_cast<double>(shown_.steps());
            report.rate = rate_at(how_.schedule, how_.rate, when, static_cast<double>(how_.epochs));
            const std::span<const std::size_t> places = shown_.batch(step, order);
            const double loss = train_batch(places, epoch, report.rate);
            detail::check_loss(loss, report, "step " + std::to_string(step + 1));
            report.loss += loss * static_cast<double>(places.size()) / static_cast<double>(order.size());
        }
        detail::check_parameters(network_->learnable_values(), report);
        detail::check_parameters(network_->running_statistics(), report);
        detail::check_squares(step_.optimiser().second, report);
        if ((epoch + 1) % how_.validate_every == 0 || epoch + 1 == how_.epochs) {
            if (how_.remeasure_statistics)
                step_.remeasure_statistics(candidate(), samples_, split_.training);
            if (!split_.validation.empty())
                validate(report);
        }
        return report;
    }

    /// One step of gradient descent. Returns the mean loss of its batch before the step.
    double train_batch(std::span<const std::size_t> places, std::size_t epoch, double rate) {
        step_.in().fill(places.size(), [&](std::size_t i, std::span<float> sample) {
            shown_.make(places[i], epoch, sample);
        });
        std::vector<std::size_t> labels(places.size());
        std::transform(places.begin(), places.end(), labels.begin(),
                       [&](std::size_t place) { return shown_.label(place, epoch); });
        const double loss = step_.run(labels, rate);
        if (how_.averaging > 0)
            average();
        return loss;
    }

    void average() {
        const auto steps = static_cast<double>(step_.optimiser().steps);
        const auto past = static_cast<float>(std::min(how_.averaging, (1 + steps) / (10 + steps)));
        detail::blend(averaged_->learnable_values(), network_->learnable_values(), 1 - past);
        detail::blend(averaged_->running_statistics(), network_->running_statistics(), 1 - past);
    }

    void validate(epoch_report& report) {
        const evaluation result =
            evaluate(candidate(), mean(), scale(), samples_, split_.validation, threads_, {}, function());
        detail::check_loss(result.loss, report, "validation");
        report.validation_loss = result.loss;
        report.validation_accuracy = result.confusion.accuracy();
        if (progress_.validated(result.loss))
            best_->copy_from(candidate());
        progress_.stopped = stopping_.check(result.loss);
    }

    std::unique_ptr<trainable> network_, averaged_, best_;
    std::unique_ptr<trainable> kept_; ///< the candidate before the epoch
    recipe how_;
    labelled_samples samples_;
    data_split split_;
    thread_pool& threads_;
    epoch_samples shown_;
    early_stopping stopping_;
    training_progress progress_;
    detail::gradient_step step_;
};

}} // namespace tactnet
