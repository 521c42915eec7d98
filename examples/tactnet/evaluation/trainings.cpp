#include "evaluation/trainings.hpp"

#include "console.hpp"
#include "data/input_file.hpp"
#include "files/claims.hpp"
#include "files/output_files.hpp"
#include "methods/description.hpp"
#include "methods/networks/compiled.hpp"
#include "methods/registry.hpp"
#include "methods/weights.hpp"
#include "number_options.hpp"
#include "reports/classes.hpp"
#include "reports/neighbours.hpp"

#include <tactnet/io/checkpoint.hpp>
#include <tactnet/io/write_file.hpp>

#include <atomic>
#include <chrono>
#include <exception>
#include <interrupt.hpp>
#include <list>
#include <mutex>
#include <set>

namespace {

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
    const auto scaling = fit_temperature(validation, validation_images, data);
    if (scaling)
        result.calibration = calibration_of(test, test_images, data, *scaling);
    if (!t.of->predictions.empty()) {
        const auto path = predictions_of(*t.of, result.settings);
        make_folder_of(path);
        tactnet::write_file(path, predictions_csv(data, test_images, test, scaling ? scaling->temperature : 1,
                                                  {{"split", name_of(t.rule)}, {"seed", t.seed}}));
    }
    if (const auto reflections = trained.reflections())
        result.reflected_accuracy =
            trained.evaluate(data.view(), test_images, alone, *reflections).confusion.accuracy();
    result.validation_accuracy = validation.confusion.accuracy();
    result.training_accuracy = evaluated(training_images).confusion.accuracy();
    return result;
}

/// Trains on one thread, until it is finished or interrupted. Then the scores of its short trainings are
/// kept.
std::unique_ptr<training_run> train(const task& t, const std::filesystem::path& kept,
                                    tactnet::thread_pool& alone) {
    const candidate& c = *t.of;
    const image_data& data = *c.data;
    auto split = split_for(data, c.training, t.rule, t.seed);
    tactnet::trial_scores trials;
    if (std::filesystem::exists(kept)) {
        tactnet::load_checkpoint(
            kept, {}, [](auto) {}, t.settings);
        trials = trials_in(tactnet::safetensors_source::open(kept));
    }
    const tactnet::recipe recipe = choose_recipe(
                                       *c.what, c.training, data, split.training, t.seed, alone,
                                       [](std::size_t, std::size_t) { return interrupted(); }, &trials)
                                       .chosen;
    auto training = c.what->train(recipe, data.view(), std::move(split), t.seed, alone, c.pretrained);
    start(*training, c.start.get());
    while (!training->finished() && !interrupted())
        training->advance();
    if (!training->finished() && !trials.empty()) {
        make_folder_of(kept);
        tactnet::save_checkpoint(kept, {}, {}, with_trials(t.settings, trials));
    }
    return training;
}

/// Returns results in single precision, and in 8 bits if the task says so; nothing if it was interrupted.
std::vector<training_result> run(const task& t, const std::filesystem::path& trials) {
    const image_data& data = *t.of->data;
    tactnet::thread_pool alone;
    const stopwatch watch;
    const auto training = train(t, trials, alone);
    const double seconds = watch.seconds();
    if (!training->finished())
        return {};
    const auto best = training->best(data.images.classes);
    std::vector<training_result> results{result_of(*best, t, *training, in_single_precision(t.settings))};
    if (t.of->training.bits == 8)
        results.push_back(result_of(*in_eight_bits(*best, data.view(), training->split().training), t,
                                    *training, t.settings));
    const auto* by_epochs = dynamic_cast<const epoch_training*>(training.get());
    for (training_result& result : results) {
        result.seconds = seconds;
        result.epochs = by_epochs != nullptr ? by_epochs->history().size() : 1;
    }
    return results;
}

std::string title_of(const task& t) {
    return fmt::format("{} {}, {} split {}", t.of->what->name, t.of->what->size(), name_of(t.rule), t.seed);
}

/// Side by side, each on one thread, shared with other programs on the folder. False if interrupted.
bool run_all(const std::vector<task>& tasks, std::size_t jobs, result_list& results,
             std::vector<std::string>* diverged) {
    std::atomic<bool> failed{false};
    const stopwatch watch;
    std::mutex mutex; // of what follows
    std::list<const task*> left;
    for (const task& t : tasks)
        left.push_back(&t);
    claims mine;
    progress line;
    std::exception_ptr failure;
    std::size_t running = 0, done_here = 0;
    bool told_to_wait = false;
    const auto name_for = [&](const task& t) {
        return results.path().parent_path() / fingerprint_of(t.settings);
    };
    // A training that is this program's until released. Nothing while other programs do all that is left:
    // their results are read once there, and what a program that ended has left undone is done here.
    const auto claim_one = [&]() -> const task* {
        for (auto t = left.begin(); t != left.end();) {
            const task* const found = *t;
            if (!mine.take(name_for(*found))) {
                ++t;
                continue;
            }
            // Under the claim: another program may have finished it since the list was read.
            results.read_on();
            t = left.erase(t);
            if (!results.has(found->settings))
                return found;
            mine.release(name_for(*found));
        }
        return nullptr;
    };
    const auto keep = [&](const task& t, std::vector<training_result> found) {
        const double accuracy = found.back().confusion.accuracy();
        for (training_result& result : found)
            if (results.find(result.settings) == nullptr) // single precision may be there from before
                results.add(std::move(result));
        const std::size_t done = tasks.size() - left.size() - running;
        ++done_here;
        line.show(fmt::format("{} of {} trainings, {}: {:.2f} %, {}", done, tasks.size(), title_of(t),
                              100 * accuracy, time_left(watch.seconds(), done_here, tasks.size() - done)),
                  done == tasks.size());
    };
    const auto do_one = [&](const task& t) {
        std::vector<training_result> found;
        std::string problem;
        try {
            found = run(t, trials_of(t, results));
        } catch (const tactnet::training_diverged& error) {
            problem = title_of(t) + ": " + error.what();
            if (diverged == nullptr)
                throw tactnet::training_diverged(problem);
        }
        const std::lock_guard lock(mutex);
        --running;
        if (!found.empty()) {
            keep(t, std::move(found));
            std::error_code ignored;
            std::filesystem::remove(trials_of(t, results), ignored);
        } else if (!problem.empty())
            diverged->push_back(problem);
        mine.release(name_for(t));
    };
    const auto work = [&]() noexcept {
        try {
            while (!failed && !interrupted()) {
                const task* next = nullptr;
                {
                    const std::lock_guard lock(mutex);
                    next = claim_one();
                    running += next != nullptr;
                    if (next == nullptr && left.empty())
                        return;
                    if (next == nullptr && !std::exchange(told_to_wait, true)) {
                        line.end_line();
                        tell("waiting for {} trainings that other programs do in this folder of results\n",
                             left.size());
                    }
                }
                if (next != nullptr)
                    do_one(*next);
                else
                    std::this_thread::sleep_for(std::chrono::milliseconds(200));
            }
        } catch (...) { // also what goes wrong while an error is put into words: no memory
            const std::lock_guard lock(mutex);
            if (!failed.exchange(true))
                failure = std::current_exception();
        }
    };
    {
        const std::size_t wanted = std::min(jobs, tasks.size());
        std::vector<std::jthread> workers; // which end before this does, whatever is thrown
        try {
            while (workers.size() + 1 < wanted)
                workers.emplace_back(work);
        } catch (const std::exception&) { // no thread or no memory: fewer give the same results
            const std::lock_guard lock(mutex);
            line.end_line();
            tell("the system refuses more threads: {} trainings at a time in place of {}\n",
                 workers.size() + 1, wanted);
        }
        work();
    }
    if (failure)
        std::rethrow_exception(failure);
    return !interrupted();
}

} // namespace

std::filesystem::path predictions_of(const candidate& c, const tactnet::file_metadata& settings) {
    return c.predictions / (fingerprint_of(settings) + ".csv");
}

std::filesystem::path trials_of(const task& t, const result_list& results) {
    return results.path().parent_path() / "trials" / fingerprint_of(t.settings);
}

void add_evaluation_options(CLI::App& app, evaluation_options& o) {
    add_data_option(app, o.data);
    app.add_option(
        "--results", o.results,
        "Folder for results, which several programs can share; finished trainings are not repeated");
    add_group_options(app, o.groups);
    add_split_option(app, o.split, "both, random and blocked", "both");
    add_option(app, "--splits", o.splits, whole_number(1, 10'000),
               fmt::format("Splits of each kind (default: all folds, or {})", o.usual_splits));
    add_option(app, "--jobs,--threads", o.jobs, whole_number(1, 1024),
               "Trainings at the same time; the results do not depend on it (default: one per core)");
    app.add_flag(
        "--elsewhere", o.elsewhere,
        "Take trainings that another version or instruction set made, where this program has made none, "
        "in place of training; they may differ in a few images");
}

std::string take_from_elsewhere(std::vector<task>& tasks, const result_list& results, bool in_part) {
    std::set<std::string> programs;
    std::size_t count = 0;
    for (task& t : tasks) {
        const training_result* found = results.find_elsewhere(t.settings);
        if (found == nullptr && in_part) // in 8 bits it was not
            found = results.find_elsewhere(in_single_precision(t.settings));
        if (found == nullptr || results.find(t.settings) != nullptr)
            continue;
        tactnet::file_metadata settings = t.settings;
        for (const char* key : {"library", "instruction_set"})
            settings[key] = found->settings.at(key);
        if (!in_part && !results.has(settings))
            continue;
        t.settings = std::move(settings);
        programs.insert(
            fmt::format("tactnet {} for {}", t.settings["library"], t.settings["instruction_set"]));
        ++count;
    }
    const std::string words = count == 0 ? ""
                                         : fmt::format("{} of {} trainings are by {}", count, tasks.size(),
                                                       fmt::join(programs, ", "));
    if (count > 0)
        tell("warning: {}, not by this program\n", printable(words));
    return words;
}

void tell_others(const std::vector<task>& tasks, const result_list& results) {
    std::vector<tactnet::file_metadata> wanted;
    for (const task& t : tasks)
        wanted.push_back(t.settings);
    if (const std::string others = results.others(wanted); !others.empty())
        tell("{}\n", printable(others));
}

namespace {

split_plan plan_of(const evaluation_options& o, const candidate& c, std::uint64_t first_seed) {
    using tactnet::split_rule;
    split_plan plan{{split_rule::random, split_rule::blocked}, first_seed, o.usual_splits};
    const image_data& data = *c.data;
    if (o.split != "both" && !(o.split.empty() && data.groups.empty() && !data.given)) {
        plan.rules = {split_rule_for(o.split, data)};
        plan.splits = splits_of(plan.rules.front(), data, c.training.folds).value_or(o.usual_splits);
    }
    plan.splits = o.splits.value_or(plan.splits);
    return plan;
}

} // namespace

split_plan load_candidates(candidate_list& list, const evaluation_options& o, std::uint64_t first_seed) {
    split_plan plan;
    std::map<std::pair<std::size_t, std::size_t>, std::shared_ptr<const image_data>> loaded;
    for (candidate& c : list) {
        std::shared_ptr<const image_data>& images = loaded[{c.what->rows, c.what->columns}];
        if (!images)
            images = std::make_shared<const image_data>(
                load_data(o.data, c.what->rows, c.what->columns, c.training.images, o.groups));
        c.data = images;
        const std::size_t classes = images->images.classes.size();
        check_capacity(*c.what, o.data, classes);
        plan = plan_of(o, c, first_seed);
        for (const tactnet::split_rule rule : plan.rules)
            for (std::size_t split = 0; split < plan.splits; ++split)
                if (split_for(*images, c.training, rule, plan.first_seed + split).test.empty())
                    refuse(
                        "{}: expected enough images for a test, of which --test takes a share of {}, found "
                        "{} of {} classes",
                        o.data, c.training.shares.test, images->images.size(), classes);
        c.start = load_start(*c.what, c.training, images->images.classes);
        c.pretrained = open_pretrained(*c.what, c.training);
    }
    for (const tactnet::split_rule rule : plan.rules)
        tell_neighbours(*list.front().data,
                        split_for(*list.front().data, list.front().training, rule, plan.first_seed));
    return plan;
}

std::vector<task> tasks_of(const candidate_list& candidates, const split_plan& plan) {
    std::vector<task> all;
    for (std::size_t split = 0; split < plan.splits; ++split)
        for (const candidate& c : candidates)
            for (const tactnet::split_rule rule : plan.rules) {
                const std::uint64_t seed = plan.first_seed + split;
                all.push_back({&c, rule, seed, describe_training(*c.what, c.training, rule, seed, *c.data)});
                all.back().settings.merge(describe_trials(*c.what, c.training, *c.data));
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
    const auto of_others = std::ranges::count_if(
        to_do, [&](const task& t) { return results.find_elsewhere(t.settings) != nullptr; });
    if (of_others > 0)
        tell("{} of these lie there, made by another version or for another instruction set than {}; to take "
             "them, add --elsewhere\n",
             of_others, to_do.front().settings.at("instruction_set"));
    if (!to_do.empty())
        tell_others(all, results);
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
