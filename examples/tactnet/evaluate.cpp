// tactnet evaluate: networks trained and tested on many splits, and what each costs. Or a weight file, see
// evaluate_weights.cpp.

#include "evaluate.hpp"

#include "commands.hpp"
#include "data.hpp"
#include "interrupt.hpp"
#include "plot.hpp"
#include "progress.hpp"
#include "registry.hpp"
#include "report.hpp"
#include "results.hpp"
#include "settings.hpp"
#include "usage_error.hpp"

#include <tactnet/io/file.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <exception>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <system_error>
#include <thread>

namespace {

/// A network at one size, with the images of that size.
struct candidate {
    const method* network;
    training_settings training;
    const image_data* data;
    std::shared_ptr<const trained_method> start{};
};

/// One training to do.
struct task {
    const candidate* what;
    tactnet::split_rule rule;
    std::uint64_t seed;
    tactnet::file_metadata settings;
};

/// On one thread. Nothing if it was interrupted.
std::optional<training_result> run(const task& t) {
    const image_data& data = *t.what->data;
    const std::vector<std::string>& classes = data.images.classes;
    tactnet::thread_pool alone;
    const auto training = t.what->network->train(
        recipe_for(t.what->network->name, t.what->training), data.view(),
        tactnet::split_data(data.images.labels, classes.size(), t.rule, t.seed, t.what->training.shares),
        t.seed, alone);
    start(*training, t.what->start.get());
    const stopwatch watch;
    while (!training->finished()) {
        if (interrupted())
            return std::nullopt;
        training->advance();
    }
    training_result result;
    result.seconds = watch.seconds();
    const auto best = training->best(classes);
    result.settings = t.settings;
    result.confusion = best->evaluate(data.view(), training->split().test, alone).confusion;
    result.validation_accuracy =
        best->evaluate(data.view(), training->split().validation, alone).confusion.accuracy();
    const auto* by_epochs = dynamic_cast<const network_training*>(training.get());
    result.epochs = by_epochs != nullptr ? by_epochs->history().size() : 1;
    const std::size_t images =
        by_epochs != nullptr ? by_epochs->images_per_epoch() : training->split().training.size();
    result.images_per_second = static_cast<double>(images * result.epochs) / result.seconds;
    return result;
}

/// Runs the tasks side by side, each on one thread; results are kept as they come. False if interrupted.
bool run_all(const std::vector<task>& tasks, std::size_t jobs, result_list& results) {
    std::mutex mutex;
    std::atomic<std::size_t> next{0};
    std::atomic<bool> failed_once{false};
    std::exception_ptr failure;
    std::size_t done = 0;
    progress line;
    const stopwatch watch;
    const auto work = [&] {
        for (std::size_t i = 0; !failed_once && !interrupted() && (i = next++) < tasks.size();) {
            const task& t = tasks[i];
            const auto name =
                fmt::format("{} {}x{}, {} split {}", t.what->network->name, t.what->network->rows,
                            t.what->network->columns, name_of(t.rule), t.seed);
            try {
                auto result = run(t);
                const std::lock_guard lock(mutex);
                if (!result)
                    return;
                const double accuracy = result->confusion.accuracy();
                results.add(std::move(*result));
                ++done;
                const double left =
                    watch.seconds() / static_cast<double>(done) * static_cast<double>(tasks.size() - done);
                line.show(fmt::format("{} of {} trainings, {}: {:.2f} %, {} left", done, tasks.size(), name,
                                      100 * accuracy, duration_text(left)),
                          done == tasks.size());
            } catch (const tactnet::training_diverged& error) {
                const std::lock_guard lock(mutex);
                if (!failed_once.exchange(true))
                    failure = std::make_exception_ptr(tactnet::training_diverged(name + ": " + error.what()));
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (!failed_once.exchange(true))
                    failure = std::current_exception();
            }
        }
    };
    std::vector<std::thread> workers;
    for (std::size_t j = 1; j < std::min(jobs, tasks.size()); ++j)
        workers.emplace_back(work);
    work();
    for (std::thread& worker : workers)
        worker.join();
    line.end_line();
    if (failure)
        std::rethrow_exception(failure);
    return !interrupted();
}

/// A row of the table.
struct summary {
    const candidate* what;
    network_costs costs;
    frame_times times;
    std::vector<split_accuracy> accuracies; ///< by the rules that were asked for
    tactnet::mean_and_deviation seconds;
    tactnet::confusion_matrix confusion;
    std::size_t splits = 0;
};

std::string percent(const tactnet::mean_and_deviation& m) {
    return fmt::format("{:.2f} ± {:.2f}", 100 * m.mean, 100 * m.deviation);
}

std::string table_of(const std::vector<summary>& rows) {
    std::vector<std::vector<std::string>> cells;
    for (const summary& s : rows) {
        std::vector<std::string> head{"network", "size"},
            line{s.what->network->name,
                 fmt::format("{}x{}", s.what->network->rows, s.what->network->columns)};
        for (const auto& [rule, accuracy] : s.accuracies) {
            head.push_back(fmt::format("{}, %", name_of(rule)));
            line.push_back(percent(accuracy));
        }
        head.insert(head.end(), {"parameters", "multiply-adds", "on pixels", "bytes", "µs/frame", "µs in 64",
                                 "training, s"});
        line.insert(line.end(),
                    {grouped(s.costs.parameters), grouped(s.costs.multiply_adds),
                     grouped(s.costs.multiply_adds_on_pixels), grouped(s.costs.parameter_bytes),
                     fmt::format("{:.1f}", s.times.alone), fmt::format("{:.1f}", s.times.in_batch),
                     fmt::format("{:.1f}", s.seconds.mean)});
        if (cells.empty())
            cells.push_back(std::move(head));
        cells.push_back(std::move(line));
    }
    return table(cells);
}

nlohmann::ordered_json json_of(const summary& s) {
    nlohmann::ordered_json json{{"network", s.what->network->name},
                                {"rows", s.what->network->rows},
                                {"columns", s.what->network->columns},
                                {"recipe", s.what->training.recipe},
                                {"splits", s.splits}};
    for (const auto& [rule, accuracy] : s.accuracies) {
        json[fmt::format("{}_accuracy", name_of(rule))] = accuracy.mean;
        json[fmt::format("{}_deviation", name_of(rule))] = accuracy.deviation;
    }
    json["parameters"] = s.costs.parameters;
    json["multiply_adds"] = s.costs.multiply_adds;
    json["multiply_adds_on_pixels"] = s.costs.multiply_adds_on_pixels;
    json["bytes"] = s.costs.parameter_bytes;
    json["activation_bytes"] = s.costs.activation_bytes;
    json["microseconds"] = s.times.alone;
    json["microseconds_in_batch"] = s.times.in_batch;
    json["training_seconds"] = s.seconds.mean;
    return json;
}

/// The same numbers as the JSON lines, in their order.
std::string csv_of(const std::vector<summary>& rows) {
    std::string text;
    for (const summary& s : rows) {
        std::string head, line;
        const nlohmann::ordered_json cells = json_of(s);
        for (const auto& [key, value] : cells.items()) {
            head += (head.empty() ? "" : ",") + key;
            line += (line.empty() ? "" : ",") +
                    (value.is_string() ? csv_field(value.get<std::string>()) : value.dump());
        }
        text += (text.empty() ? head + '\n' : "") + line + '\n';
    }
    return text;
}

std::vector<std::pair<std::size_t, std::size_t>> sizes_of(const evaluate_options& o) {
    std::vector<std::pair<std::size_t, std::size_t>> sizes;
    for (const std::string& text : o.sizes) {
        std::size_t rows = 0, columns = 0;
        int used = 0;
        if (std::sscanf(text.c_str(), "%zux%zu%n", &rows, &columns, &used) != 2 ||
            static_cast<std::size_t>(used) != text.size())
            throw usage_error(fmt::format("--sizes: expected sizes such as 28x50, found '{}'", text));
        sizes.emplace_back(rows, columns);
    }
    if (sizes.empty())
        sizes.emplace_back(o.training.rows, o.training.columns);
    return sizes;
}

std::vector<tactnet::split_rule> rules_of(const evaluate_options& o) {
    if (o.split == "both")
        return {tactnet::split_rule::random, tactnet::split_rule::blocked};
    return {split_rule_of(o.split)};
}

int evaluate(const evaluate_options& o) {
    // All that can be wrong comes first.
    std::vector<candidate> candidates;
    for (const auto& [rows, columns] : sizes_of(o))
        for (const std::string& name : o.networks) {
            training_settings training = o.training;
            training.rows = rows, training.columns = columns;
            static_cast<void>(recipe_for(name, training));
            candidates.push_back({&find_method(name, rows, columns), training, nullptr});
        }
    if (o.training.shares.test <= 0)
        throw usage_error(
            "--test: expected a share above 0, since accuracy is measured on these images, found 0");
    const std::filesystem::path folder = o.results;
    check_writable(folder / "evaluation.jsonl");
    std::map<std::pair<std::size_t, std::size_t>, image_data> data;
    for (candidate& c : candidates) {
        const std::pair size{c.network->rows, c.network->columns};
        if (!data.contains(size))
            data.emplace(size, load_data(o.data, size.first, size.second, o.training.resize));
        c.data = &data.at(size);
        check_capacity(*c.network, o.data, c.data->images.classes.size());
        c.start = load_start(*c.network, c.training, c.data->images.classes);
    }
    if (o.afresh) {
        std::error_code ignored;
        std::filesystem::remove(folder / "evaluation.jsonl", ignored);
    }
    result_list results(folder / "evaluation.jsonl");

    const std::vector<tactnet::split_rule> rules = rules_of(o);
    std::vector<task> all, to_do;
    for (std::uint64_t seed = o.first_seed; seed < o.first_seed + o.splits; ++seed)
        for (const candidate& c : candidates)
            for (const tactnet::split_rule rule : rules)
                all.push_back({&c, rule, seed,
                               describe_training(*c.network, c.training, rule, seed, c.data->fingerprint)});
    for (const task& t : all)
        if (results.find(t.settings) == nullptr)
            to_do.push_back(t);
    fmt::print(stderr, "{} trainings to do, {} done before ({})\n", to_do.size(), all.size() - to_do.size(),
               (folder / "evaluation.jsonl").string());
    catch_interrupts();
    if (!to_do.empty() && !run_all(to_do, o.jobs, results)) {
        fmt::print(stderr, "stopped; the same command goes on with what is left\n");
        return interrupted_by_user;
    }

    std::vector<summary> rows;
    std::vector<cost_point> points;
    std::string lines;
    for (const candidate& c : candidates) {
        const std::vector<std::string>& classes = c.data->images.classes;
        summary s{&c,
                  c.network->costs(classes.size()),
                  c.network->time_frames(),
                  {},
                  {},
                  tactnet::confusion_matrix(classes.size()),
                  o.splits};
        std::vector<double> seconds;
        std::string splits;
        for (const tactnet::split_rule rule : rules) {
            std::vector<double> accuracies;
            for (const task& t : all) {
                if (t.what != &c || t.rule != rule)
                    continue;
                const training_result& r = *results.find(t.settings);
                accuracies.push_back(r.confusion.accuracy());
                seconds.push_back(r.seconds);
                s.confusion.add(r.confusion);
            }
            s.accuracies.push_back({rule, tactnet::mean_and_deviation::of(accuracies)});
            splits += fmt::format("{}{} {}", splits.empty() ? "" : " and ", o.splits, name_of(rule));
        }
        s.seconds = tactnet::mean_and_deviation::of(seconds);
        const auto name = fmt::format("{} {}x{}", c.network->name, c.network->rows, c.network->columns);
        points.push_back({name, static_cast<double>(s.costs.multiply_adds), s.times.alone, s.accuracies});
        plot_confusion(
            folder / fmt::format("confusion_{}_{}x{}", c.network->name, c.network->rows, c.network->columns),
            fmt::format("{}, {} splits", name, splits), s.confusion, classes);
        lines += json_of(s).dump() + '\n';
        rows.push_back(std::move(s));
    }
    tactnet::write_file(folder / "table.jsonl", lines);
    tactnet::write_file(folder / "table.csv", csv_of(rows));
    plot_costs(folder / "accuracy_and_cost", points);
    fmt::print("{}", table_of(rows));
    fmt::print(
        "accuracy: test images, mean ± standard deviation of {} splits each; µs: this machine, one thread\n",
        o.splits);
    return success;
}

} // namespace

command add_evaluate(CLI::App& program) {
    auto* app =
        program.add_subcommand("evaluate", "Train and test networks on many splits, or test a weight file");
    auto o = std::make_shared<evaluate_options>();
    app->add_option("--data", o->data,
                    "Folder with one subfolder a class, each with 8-bit grey JPEG or PNG images")
        ->type_name("FOLDER")
        ->required();
    app->add_option("--network,--method", o->networks,
                    "Networks and machines, separated by commas; of " + method_names() +
                        " (default: tactnet4,tactnet6)")
        ->type_name("NAME,...")
        ->delimiter(',');
    add_training_options(*app, o->training);
    app->add_option("--sizes", o->sizes,
                    "Several sizes, such as 28x50,14x25, instead of --rows and --columns; images of another "
                    "size need --resize")
        ->type_name("SIZE,...")
        ->delimiter(',');
    app->add_option("--split", o->split,
                    "'random', 'blocked' (neighbours in the order of recording stay together) or 'both'")
        ->check(CLI::IsMember({"both", "random", "blocked"}))
        ->capture_default_str();
    app->add_option("--splits", o->splits, "Splits of each kind, 1 to 10000")
        ->type_name("N")
        ->check(CLI::Range(1, 10'000))
        ->capture_default_str();
    app->add_option("--seed", o->first_seed, "Seed of the first split; the others follow")
        ->type_name("N")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    app->add_option("--results", o->results,
                    "Folder for results; finished trainings found there are not done again")
        ->type_name("FOLDER")
        ->capture_default_str();
    app->add_flag("--afresh", o->afresh,
                  "Forget finished trainings found there, as one should when the library itself has changed");
    app->add_option(
           "--jobs,--threads", o->jobs,
           "Trainings at the same time, 1 to 1024; the results do not depend on it (default: one a core)")
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    add_weight_options(*app, o->weights, false);
    app->add_option("--images", o->images,
                    "With --weights: the 'test' images of the split it was trained on, or 'all'")
        ->check(CLI::IsMember({"test", "all"}))
        ->capture_default_str();
    return [o, app] {
        if (o->weights.weights.empty()) {
            if (o->networks.empty())
                o->networks = {"tactnet4", "tactnet6"};
            return evaluate(*o);
        }
        o->weights.resize = o->training.resize;
        if (o->networks.size() > 1)
            throw usage_error(fmt::format("--network: expected one network for one weight file, found {}",
                                          o->networks.size()));
        if (!o->networks.empty())
            o->weights.network = o->networks.front();
        if (app->count("--rows") > 0)
            o->weights.rows = o->training.rows;
        if (app->count("--columns") > 0)
            o->weights.columns = o->training.columns;
        return evaluate_weights(*o);
    };
}
