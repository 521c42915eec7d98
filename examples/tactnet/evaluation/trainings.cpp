#include "evaluation/trainings.hpp"

#include "console.hpp"
#include "data/input_file.hpp"
#include "files/claims.hpp"
#include "methods/description.hpp"
#include "methods/registry.hpp"
#include "methods/weights.hpp"
#include "number_options.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/training/loop.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <exception>
#include <filesystem>
#include <interrupt.hpp>
#include <limits>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <span>
#include <stopwatch.hpp>
#include <string>
#include <thread>
#include <utility>

namespace {

/// How many there are does not depend on the rule or the seed.
void check_test_images(const std::filesystem::path& folder, const training_settings& training,
                       const image_data& data) {
    const auto split = tactnet::split_data(data.images.labels, data.images.classes.size(),
                                           tactnet::split_rule::random, 0, training.shares);
    if (split.test.empty())
        throw tactnet::file_error(
            folder.string(), "",
            fmt::format("enough images for a test, of which --test takes a share of {}",
                        training.shares.test),
            fmt::format("{} of {} classes", data.images.size(), data.images.classes.size()));
}

/// Tests a trained method on the images of its split.
training_result result_of(const trained_method& trained, const task& t, const training_run& training,
                          tactnet::file_metadata settings) {
    const image_data& data = *t.of->data;
    tactnet::thread_pool alone;
    const auto evaluated = [&](std::span<const std::size_t> images) {
        return trained.evaluate(data.view(), images, alone);
    };
    const auto& [training_images, validation_images, test_images] = training.split();
    const tactnet::evaluation test = evaluated(test_images), validation = evaluated(validation_images);
    training_result result;
    result.settings = std::move(settings);
    result.confusion = test.confusion;
    if (const auto scaling = fit_temperature(validation, validation_images, data))
        result.calibration = calibration_of(test, test_images, data, *scaling);
    if (!test.logits.empty() && !t.of->what->pretrained()) {
        result.decisions = sets_of_classes(validation, test, data, training.split());
        add_means(result.decisions, faults_of_sensor(trained, data, test_images, t.seed, alone));
    }
    if (trained.averages_reflections())
        result.reflected_accuracy =
            trained.evaluate(data.view(), test_images, alone, tactnet::test_time_augmentation::reflections)
                .confusion.accuracy();
    result.validation_accuracy = validation.confusion.accuracy();
    result.training_accuracy = evaluated(training_images).confusion.accuracy();
    return result;
}

/// Trains on one thread, until it is finished or interrupted.
std::unique_ptr<training_run> train(const candidate& c, const task& t, tactnet::thread_pool& alone) {
    auto training = c.what->train(recipe_for(*c.what, c.training), c.data->view(),
                                  tactnet::split_data(c.data->images.labels, c.data->images.classes.size(),
                                                      t.rule, t.seed, c.training.shares),
                                  t.seed, alone, c.pretrained);
    start(*training, c.start.get());
    while (!training->finished() && !interrupted())
        training->advance();
    return training;
}

/// Trains without some classes, and scores the images of these. Nothing if it was interrupted.
decision_means unknown_objects(const task& t) {
    const class_choice chosen =
        choose_classes(t.of->data->images.classes.size(), t.of->training.unknown, t.seed);
    candidate of_known = *t.of;
    of_known.data = std::make_shared<const image_data>(images_of_classes(*t.of->data, chosen.known));
    tactnet::thread_pool alone;
    const auto training = train(of_known, t, alone);
    if (!training->finished())
        return {};
    const auto best = training->best(of_known.data->images.classes);
    image_data others = images_of_classes(*t.of->data, chosen.unknown);
    std::ranges::fill(others.images.labels, 0U); // labels of no use, which the method must have
    others.images.classes = of_known.data->images.classes;
    return separation(best->evaluate(of_known.data->view(), training->split().test, alone),
                      best->evaluate(others.view(), tactnet::all_samples(others.images.size()), alone),
                      chosen.known.size());
}

/// Trains on one thread. Returns results in single precision, and in 8 bits if the task says so; nothing if
/// it was interrupted.
std::vector<training_result> run(const task& t) {
    const image_data& data = *t.of->data;
    const std::vector<std::string>& classes = data.images.classes;
    tactnet::thread_pool alone;
    const stopwatch watch;
    const auto training = train(*t.of, t, alone);
    const double seconds = watch.seconds();
    const decision_means unknown = t.of->training.unknown > 0 ? unknown_objects(t) : decision_means{};
    if (!training->finished() || interrupted())
        return {};
    const auto best = training->best(classes);
    std::vector<training_result> results{result_of(*best, t, *training, in_single_precision(t.settings))};
    add_means(results.front().decisions, unknown);
    if (t.of->training.bits == 8)
        results.push_back(result_of(*in_eight_bits(*best, data.view(), training->split().training), t,
                                    *training, t.settings));
    const auto* by_epochs = dynamic_cast<const network_training*>(training.get());
    for (training_result& result : results) {
        result.seconds = seconds;
        result.epochs = by_epochs != nullptr ? by_epochs->history().size() : 1;
    }
    return results;
}

std::string title_of(const task& t) {
    return fmt::format("{} {}x{}, {} split {}", t.of->what->name, t.of->what->rows, t.of->what->columns,
                       name_of(t.rule), t.seed);
}

/// What the workers share: the trainings that are left, given out so that no two programs on one folder of
/// results do the same.
class side_by_side {
public:
    side_by_side(const std::vector<task>& tasks, result_list& results, std::vector<std::string>* diverged)
        : all_(tasks.size()), results_(results), diverged_(diverged) {
        for (const task& t : tasks)
            left_.push_back(&t);
    }

    /// One worker, until nothing is left, a training has failed, or someone interrupts.
    void work() noexcept {
        try {
            for (const task* mine = nullptr; (mine = next()) != nullptr;)
                if (!do_one(*mine))
                    return;
        } catch (...) { // also what goes wrong while an error is put into words: no memory
            fail(std::current_exception());
        }
    }
    /// Says that fewer work than were asked for.
    void tell_refused(std::size_t granted, std::size_t wanted) {
        const std::lock_guard lock(mutex_);
        line_.end_line();
        tell("the system refuses more threads: {} trainings at a time in place of {}\n", granted, wanted);
    }
    void end() {
        line_.end_line();
        if (failure_)
            std::rethrow_exception(failure_);
    }

private:
    /// Nothing when there is nothing more to do. Waits while other programs do all that is left.
    const task* next() {
        while (!failed_ && !interrupted()) {
            {
                const std::lock_guard lock(mutex_);
                if (const task* const mine = claim_one(); mine != nullptr || left_.empty())
                    return mine;
                if (!std::exchange(told_, true)) {
                    line_.end_line();
                    tell("waiting for {} trainings that other programs do in this folder of results\n",
                         left_.size());
                }
            }
            std::this_thread::sleep_for(std::chrono::milliseconds(200));
        }
        return nullptr;
    }
    /// A training that is this program's until it is released. Nothing while other programs do all that is
    /// left: their results are read when they are there, and what a program that ended has left undone is
    /// done here.
    const task* claim_one() {
        for (auto t = left_.begin(); t != left_.end();) {
            const task* const mine = *t;
            if (!claims_.take(name_for(*mine))) {
                ++t;
                continue;
            }
            // Under the claim: another program may have finished it since the list was read.
            results_.read_on();
            t = left_.erase(t);
            if (!results_.has(mine->settings))
                return mine;
            claims_.release(name_for(*mine));
            ++from_others_;
        }
        return nullptr;
    }
    std::filesystem::path name_for(const task& t) const {
        return results_.path().parent_path() / fingerprint_of(t.settings);
    }
    /// False if it was interrupted.
    bool do_one(const task& t) {
        try {
            std::vector<training_result> results = run(t);
            const bool done = !results.empty();
            if (done)
                keep(t, std::move(results));
            return done;
        } catch (const tactnet::training_diverged& error) {
            const std::string what = title_of(t) + ": " + error.what();
            if (diverged_ == nullptr)
                throw tactnet::training_diverged(what);
            const std::lock_guard lock(mutex_);
            diverged_->push_back(what);
            claims_.release(name_for(t));
            ++done_;
            return true;
        }
    }
    void keep(const task& t, std::vector<training_result> results) {
        const std::lock_guard lock(mutex_);
        const double accuracy = results.back().confusion.accuracy();
        for (training_result& result : results)
            if (results_.find(result.settings) == nullptr) // single precision may be there from before
                results_.add(std::move(result));
        claims_.release(name_for(t));
        ++done_;
        const std::size_t done = done_ + from_others_;
        line_.show(fmt::format("{} of {} trainings, {}: {:.2f} %, {}", done, all_, title_of(t),
                               100 * accuracy, time_left(watch_.seconds(), done_, all_ - done)),
                   done == all_);
    }
    void fail(std::exception_ptr failure) noexcept {
        const std::lock_guard lock(mutex_);
        if (!failed_.exchange(true))
            failure_ = std::move(failure);
    }

    const std::size_t all_;
    std::atomic<bool> failed_{false};
    stopwatch watch_;
    std::mutex mutex_; ///< of what follows
    result_list& results_;
    std::list<const task*> left_;
    claims claims_;
    std::size_t from_others_ = 0; ///< results that other programs have brought
    bool told_ = false;           ///< that it waits
    std::vector<std::string>* const diverged_;
    std::exception_ptr failure_;
    std::size_t done_ = 0;
    progress line_;
};

/// Side by side, each on one thread.
bool run_all(const std::vector<task>& tasks, std::size_t jobs, result_list& results,
             std::vector<std::string>* diverged) {
    side_by_side shared(tasks, results, diverged);
    {
        const std::size_t wanted = std::min(jobs, tasks.size());
        std::vector<std::jthread> workers; // which end before this does, whatever is thrown
        try {
            while (workers.size() + 1 < wanted)
                workers.emplace_back([&] { shared.work(); });
        } catch (
            const std::exception&) { // no thread or no memory; results do not depend on how many there are
            shared.tell_refused(workers.size() + 1, wanted);
        }
        shared.work();
    }
    shared.end();
    return !interrupted();
}

} // namespace

void add_split_options(CLI::App& app, std::string& split, std::size_t& splits, std::size_t& jobs) {
    app.add_option("--split", split,
                   "'random', 'blocked' (neighbours in the order of recording stay together) or 'both'")
        ->check(CLI::IsMember({"both", "random", "blocked"}));
    app.add_option("--splits", splits, "Splits of each kind")->check(whole_number(1, 10'000));
    app.add_option("--jobs,--threads", jobs,
                   "Trainings at the same time; the results do not depend on it (default: one per core)")
        ->check(whole_number(1, 1024));
}

std::vector<tactnet::split_rule> rules_of(const std::string& names) {
    if (names == "both")
        return {tactnet::split_rule::random, tactnet::split_rule::blocked};
    return {split_rule_of(names)};
}

void check_seeds(const split_plan& plan) {
    if (plan.splits - 1 > std::numeric_limits<std::uint64_t>::max() - plan.first_seed)
        refuse("--seed, --splits: expected seeds below 2^64 for all splits, found {} "
               "of them from {} on",
               plan.splits, plan.first_seed);
}

void load_candidates(candidate_list& list, const std::filesystem::path& data) {
    std::map<std::pair<std::size_t, std::size_t>, std::shared_ptr<const image_data>> loaded;
    for (candidate& c : list) {
        std::shared_ptr<const image_data>& images = loaded[{c.what->rows, c.what->columns}];
        if (!images)
            images = std::make_shared<const image_data>(
                load_data(data, c.what->rows, c.what->columns, c.training.resize));
        c.data = images;
        check_capacity(*c.what, data.string(), images->images.classes.size());
        check_test_images(data, c.training, *images);
        if (const std::size_t classes = images->images.classes.size();
            c.training.unknown > 0 && c.training.unknown + 2 > classes)
            refuse("--unknown: expected to leave two of {} classes or more, found {}", classes,
                   c.training.unknown);
        c.start = load_start(*c.what, c.training, images->images.classes);
        c.pretrained = open_pretrained(*c.what, c.training);
    }
}

std::vector<task> tasks_of(const candidate_list& candidates, const split_plan& plan) {
    std::vector<task> all;
    for (std::size_t split = 0; split < plan.splits; ++split)
        for (const candidate& c : candidates)
            for (const tactnet::split_rule rule : plan.rules) {
                const std::uint64_t seed = plan.first_seed + split;
                all.push_back({&c, rule, seed, describe_training(*c.what, c.training, rule, seed, *c.data)});
            }
    return all;
}

bool train_all(const std::vector<task>& all, std::size_t jobs, result_list& results,
               std::vector<std::string>* diverged) {
    std::vector<task> to_do;
    std::set<const candidate*> with_features;
    for (const task& t : all)
        if (!results.has(t.settings)) {
            to_do.push_back(t);
            if (t.of->pretrained)
                with_features.insert(t.of);
        }
    tell("{} trainings to do, of {} in all ({})\n", to_do.size(), all.size(),
         printable(results.path().string()));
    catch_interrupts();
    tactnet::thread_pool pool(with_features.empty() ? 1 : jobs);
    const bool prepared = std::ranges::all_of(with_features, [&](const candidate* c) {
        return c->pretrained->prepare(*c->data, results.path().parent_path() / "features", pool);
    });
    if (prepared && (to_do.empty() || run_all(to_do, jobs, results, diverged)))
        return true;
    tell("stopped; the same command goes on with what is left\n");
    return false;
}
