#pragma once

#include <tactnet/text/message.hpp>
#include <tactnet/training/data/held_out.hpp>
#include <tactnet/training/loop.hpp>
#include <tactnet/training/mirror_partners.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// What one trial found.
struct augmentation_trial {
    std::string what; ///< "reflections of columns"
    double gain = 0;  ///< of the probability of the right class on held-out samples, without it or with it
    double error = 0; ///< standard error of the gain
    bool adopted = false;
};
/// A recipe with the augmentation that suits a task.
struct augmentation_choice {
    recipe chosen;
    std::vector<augmentation_trial> trials;
    std::vector<std::string> reasons; ///< sentences: what was chosen and why
};
/// What a caller has decided: these parts of a recipe stay as they are.
struct fixed_augmentation {
    bool rows = false, columns = false; ///< reflections
    bool movement = false;              ///< translation, rotation and scale
    bool function = false;              ///< of counts
};
/// What each short training has scored so far, in the order of the search. A caller who stores them need not
/// repeat these trainings after an interruption.
using trial_scores = std::vector<std::vector<double>>;
/// Whether a search should end. Asked before its first epoch and after each, more than once between short
/// trainings, with the epochs done and all of the search. A known training counts as done at once.
using search_stop = std::function<bool(std::size_t done, std::size_t all)>;

namespace detail {

/// A recipe that differs in one kind of augmentation, and the evidence that it takes to adopt it: what the
/// recipe has by default did better elsewhere, so it goes only on clear evidence.
struct recipe_variation {
    const char* what;
    void (*change)(recipe&);
    double standard_errors;
    bool fixed_augmentation::*kind;
    bool needs_groups = false; ///< what blocks of the training images say of it is mostly chance
};

inline constexpr double for_default = 2.5, for_new = 1;
inline constexpr std::array recipe_variations{
    recipe_variation{"without reflections of rows",
                     [](recipe& r) { r.ranges.reflect_rows = 0, r.reflections.rows = {}; }, for_default,
                     &fixed_augmentation::rows},
    recipe_variation{"without reflections of columns",
                     [](recipe& r) { r.ranges.reflect_columns = 0, r.reflections.columns = {}; }, for_default,
                     &fixed_augmentation::columns},
    recipe_variation{"without translation, rotation and scale",
                     [](recipe& r) { r.ranges.translation = r.ranges.rotation = r.ranges.scale = 0; },
                     for_default, &fixed_augmentation::movement},
    recipe_variation{"with the square root of counts",
                     [](recipe& r) { r.function = {count_rule::square_root}; }, for_new,
                     &fixed_augmentation::function, true}};

/// The search of choose_augmentation.
class augmentation_search {
public:
    augmentation_search(const trainable& network, const recipe& how, const labelled_samples& samples,
                        std::span<const std::size_t> training, std::span<const std::size_t> groups,
                        std::uint64_t seed, thread_pool& threads, const search_stop& stop,
                        std::size_t most_epochs, const fixed_augmentation& fixed, trial_scores& known)
        : network_(network),
          samples_(samples),
          groups_(groups),
          split_(hold_out(samples, training, groups, seed)),
          seed_(seed),
          threads_(threads),
          stop_(stop),
          most_epochs_(most_epochs),
          fixed_(fixed),
          known_(known),
          result_{how, {}, {}} {}

    [[nodiscard]] augmentation_choice run(const reflection_rule& found, std::span<const std::string> names) {
        recipe& base = result_.chosen;
        const recipe how = base;
        if (!fixed_.rows)
            reflect("rows", base.ranges.reflect_rows, base.reflections.rows, found.rows, names);
        if (!fixed_.columns)
            reflect("columns", base.ranges.reflect_columns, base.reflections.columns, found.columns, names);
        const recipe start = base;
        std::vector<std::pair<const recipe_variation*, recipe>> changed;
        for (const recipe_variation& v : recipe_variations) {
            recipe r = start;
            v.change(r);
            if (!(fixed_.*v.kind) && !(r.ranges == start.ranges && r.function == start.function) &&
                !(v.needs_groups && groups_.empty()))
                changed.emplace_back(&v, r);
        }
        epochs_ = std::min(how.epochs / 2, most_epochs_) / (changed.size() + 1);
        all_ = epochs_ * (changed.size() + 1);
        steps_ = epochs_ * ceil_div(split_.training.size(), how.batch == 0 ? samples_.size() : how.batch);
        if (most_epochs_ == 0)
            return result_;
        if (split_.validation.size() < fewest_scores || epochs_ < fewest_epochs) {
            result_.reasons.emplace_back(
                "too few images or epochs for short trainings: the rest stays as in the recipe");
            return result_;
        }
        std::size_t trial = 0;
        if (!score(start, trial++))
            return result_;
        for (const auto& [v, r] : changed) {
            if (!score(r, trial))
                return result_;
            judge(*v, known_.front(), known_[trial++]);
        }
        if (result_.reasons.empty())
            result_.reasons.emplace_back("as in the recipe: no trial did clearly better on held-out images");
        return result_;
    }

private:
    /// What mean images say of one axis.
    void reflect(std::string_view axis, double& share, reflection_rule::axis& rule,
                 const reflection_rule::axis& found, std::span<const std::string> names) {
        if (share == 0)
            return;
        rule = found;
        if (!found.reflects) {
            share = 0;
            result_.reasons.push_back(
                joined({"reflections of ", axis, ": off, since reflected images resemble no class"}));
        }
        const auto name = [&](std::size_t c) { return c < names.size() ? names[c] : std::to_string(c); };
        std::string pairs;
        for (std::size_t c = 0; c < found.partners.size(); ++c)
            if (found.partners[c] > c)
                pairs += joined({pairs.empty() ? "" : ", ", name(c), " = ", name(found.partners[c])});
        if (!pairs.empty())
            result_.reasons.push_back(joined(
                {"reflections of ", axis, " exchange the classes that mean images say they do: ", pairs}));
    }
    /// Trains shortly for the scores on what was held out, unless they are known. Returns whether they are.
    [[nodiscard]] bool score(recipe r, std::size_t trial) {
        if (trial < known_.size()) {
            if (known_[trial].size() != known_.front().size())
                throw std::invalid_argument("augmentation: expected scores of the same search, found others");
            return !stops(epochs_ * (trial + 1));
        }
        r.epochs = epochs_;
        r.validate_every = epochs_ + 1;
        r.patience = 0;
        training_loop loop(network_.copy(), r, samples_, {split_.training, {}, {}}, seed_, threads_);
        for (std::size_t done = epochs_ * trial; !stops(done); ++done) {
            if (loop.finished()) {
                known_.push_back(scores_of(evaluate(loop.latest(), loop.mean(), loop.scale(), samples_,
                                                    split_.validation, threads_, {}, loop.function()),
                                           samples_, split_.validation, groups_));
                return true;
            }
            loop.run_epoch();
        }
        return false;
    }
    [[nodiscard]] bool stops(std::size_t done) const { return stop_ && stop_(done, all_); }
    void judge(const recipe_variation& v, std::span<const double> before, std::span<const double> after) {
        double sum = 0, squares = 0;
        for (std::size_t i = 0; i < after.size(); ++i) {
            const double gain = after[i] - before[i];
            sum += gain, squares += gain * gain;
        }
        const auto n = static_cast<double>(after.size());
        augmentation_trial t{.what = v.what, .gain = sum / n};
        t.error = std::sqrt(std::max(0.0, squares / n - t.gain * t.gain) / std::max(1.0, n - 1));
        // Short trainings favour less augmentation, the shorter the more.
        const double least =
            v.standard_errors < for_default ? 0.005 : 0.01 + 10 / static_cast<double>(steps_);
        t.adopted = t.gain > least && t.gain > v.standard_errors * t.error;
        if (t.adopted) {
            v.change(result_.chosen);
            result_.reasons.push_back(
                joined({v.what, ", which raises the probability of the right class on held-out images by ",
                        points(t)}));
        }
        result_.trials.push_back(std::move(t));
    }
    static std::string points(const augmentation_trial& t) {
        const auto tenths = [](double share) {
            const auto n = std::lround(1000 * share);
            return joined({std::to_string(n / 10), ".", std::to_string(n % 10)});
        };
        return joined({tenths(t.gain), " ± ", tenths(t.error), " points"});
    }

    const trainable& network_;
    const labelled_samples& samples_;
    std::span<const std::size_t> groups_;
    data_split split_;
    std::uint64_t seed_;
    thread_pool& threads_;
    const search_stop& stop_;
    static constexpr std::size_t fewest_epochs = 4; ///< of a trial that says anything
    const std::size_t most_epochs_;
    const fixed_augmentation fixed_;
    trial_scores& known_;
    std::size_t epochs_ = 0, steps_ = 0; ///< of a trial
    std::size_t all_ = 0;                ///< epochs of the search
    augmentation_choice result_;
};

} // namespace detail

/// Finds out which kinds of augmentation and which input function suit a task, on training samples alone.
/// Mean images say which classes are each other's reflection, and whether reflected images show a class at
/// all (find_reflections). For the rest, short trainings, together half as long as a whole one and at most
/// `most_epochs` long (0: no trainings, what mean images say alone), learn three
/// quarters of the samples and are judged on the others: whole groups, if `groups` holds the group of each
/// sample. Scores are the probability of the right class, compared class by class and group by group. A kind
/// of the recipe is given up if that gains more than 2.5 standard errors and 1 + 1000 ÷ steps points, since
/// short trainings favour less augmentation; the square root of counts, tried with groups alone, is taken
/// from one standard error and half a point on.
///
/// What is `fixed` is neither tried nor changed. The network is untrained and is not changed. `names` of
/// classes are for the reasons. If `stop` says so, the search ends with what it has found. A recipe without
/// augmentation, or of features, stays as it is. Throws as `training_loop`.
[[nodiscard]] inline augmentation_choice
choose_augmentation(const trainable& network, const recipe& how, const labelled_samples& samples,
                    std::span<const std::size_t> training, std::span<const std::size_t> groups,
                    std::uint64_t seed, thread_pool& threads, std::span<const std::string> names = {},
                    const search_stop& stop = {}, std::size_t most_epochs = 220,
                    const fixed_augmentation& fixed = {}, trial_scores* known = nullptr) {
    if (!samples.are_images() || how.augmentation == augmentation_rule::none)
        return {how, {}, {"no augmentation to choose from"}};
    detail::check_chosen(network.input_shape(), samples, training, groups);
    const auto compared = detail::groups_to_compare(samples, training, groups);
    trial_scores own;
    augmentation_choice found =
        detail::augmentation_search(network, how, samples, training, compared, seed, threads, stop,
                                    most_epochs, fixed, known == nullptr ? own : *known)
            .run(find_reflections(network.input_shape(), samples, training, compared), names);
    if (compared.empty() && !groups.empty())
        found.reasons.emplace(found.reasons.begin(),
                              "each class has one group, so parts of a class take their place");
    return found;
}

}} // namespace tactnet
