// tactnet train: one network or machine on one split of a folder of images.

#include "commands.hpp"
#include "data.hpp"
#include "interrupt.hpp"
#include "machines.hpp"
#include "plot.hpp"
#include "progress.hpp"
#include "registry.hpp"
#include "report.hpp"
#include "settings.hpp"
#include "usage_error.hpp"
#include "weights.hpp"

#include <tactnet/io/file.hpp>
#include <tactnet/runtime/random.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <system_error>

namespace {

struct train_options {
    training_settings training;
    std::string data, network = "tactnet6", split = "random", output, checkpoint, plots;
    std::uint64_t seed = 0;
    std::size_t threads = 1; // more pay on an idle machine only: their barriers wait for every core
    std::size_t selftest = 4;
    double checkpoint_minutes = 5;
    bool resume = false, afresh = false;
};

/// Blots of random pressure, so that weight files can test themselves without holding anyone's recordings.
std::vector<std::uint8_t> selftest_images(std::size_t count, std::size_t rows, std::size_t columns) {
    std::vector<std::uint8_t> pixels;
    for (std::size_t i = 0; i < count; ++i) {
        tactnet::random_stream random(i, tactnet::draw::order);
        const double row = random.uniform() * static_cast<double>(rows),
                     column = random.uniform() * static_cast<double>(columns);
        const double size = 2 + random.uniform() * static_cast<double>(std::min(rows, columns)) / 2;
        for (std::size_t y = 0; y < rows; ++y)
            for (std::size_t x = 0; x < columns; ++x) {
                const double dy = static_cast<double>(y) - row, dx = static_cast<double>(x) - column;
                const double pressure = std::max(0.0, 1 - (dy * dy + dx * dx) / (size * size));
                pixels.push_back(static_cast<std::uint8_t>(pressure * (64 + 128 * random.uniform())));
            }
    }
    return pixels;
}

/// Trains until done or interrupted; tells whether it is done.
bool run(network_training& training, std::size_t epochs, const std::filesystem::path& checkpoint,
         const tactnet::file_metadata& settings, double checkpoint_minutes) {
    progress line;
    const stopwatch watch;
    const std::size_t before = training.history().size();
    double saved = 0;
    while (!training.finished()) {
        if (interrupted()) {
            line.end_line();
            return false;
        }
        training.advance();
        const auto& history = training.history();
        const tactnet::epoch_report& e = history.back();
        const double seconds = watch.seconds(), done = static_cast<double>(e.epoch - before);
        const double left = seconds / done * static_cast<double>(epochs - e.epoch);
        std::string text = fmt::format("epoch {} of {}, loss {:.4f}", e.epoch, epochs, e.loss);
        const auto validated = std::find_if(history.rbegin(), history.rend(), [](const auto& past) {
            return !std::isnan(past.validation_accuracy);
        });
        if (validated != history.rend())
            text += fmt::format(", validation {:.1f} %", 100 * validated->validation_accuracy);
        text += fmt::format(", {:.0f} images/s, {} left",
                            static_cast<double>(training.images_per_epoch()) * done / seconds,
                            duration_text(left));
        line.show(text, training.finished());
        if (seconds - saved > 60 * checkpoint_minutes) {
            make_folder_of(checkpoint);
            training.save_checkpoint(checkpoint, settings);
            saved = seconds;
        }
    }
    return true;
}

/// Hours of work may be in there. A finished training leaves none.
void check_no_checkpoint(const std::filesystem::path& path) {
    std::error_code code;
    if (std::filesystem::is_regular_file(path, code))
        throw usage_error(fmt::format("{}: expected no checkpoint here, found one of an unfinished training; "
                                      "--resume goes on from it, --afresh gives it up, --checkpoint takes "
                                      "another name",
                                      path.string()));
}

/// A network by epochs, with checkpoints. Tells whether it is done.
bool run_epochs(network_training& training, const train_options& o, std::size_t epochs,
                const std::filesystem::path& checkpoint, const tactnet::file_metadata& settings) {
    if (o.resume)
        training.load_checkpoint(checkpoint, settings);
    catch_interrupts();
    if (run(training, epochs, checkpoint, settings, o.checkpoint_minutes))
        return true;
    make_folder_of(checkpoint);
    training.save_checkpoint(checkpoint, settings);
    fmt::print(stderr, "stopped after epoch {} of {}; the same command with --resume goes on from {}\n",
               training.history().size(), epochs, checkpoint.string());
    return false;
}

/// A machine, all at once: Ctrl-C ends the program, and leaves nothing.
void run_once(training_run& training, const std::string& data) {
    try {
        training.advance();
    } catch (const std::invalid_argument& error) { // nothing to tell apart, nothing to describe
        throw usage_error(fmt::format("{}: {}", data, error.what()));
    }
}

/// What a training leaves.
struct output_files {
    std::filesystem::path weights, checkpoint;
    std::filesystem::path reports; ///< how their names begin
};

/// Throws usage_error where they cannot be written, or should not.
output_files files_for(const train_options& o) {
    const std::filesystem::path weights = o.output;
    const std::filesystem::path folder =
        o.plots.empty() ? weights.parent_path() : std::filesystem::path(o.plots);
    output_files files{weights, o.checkpoint.empty() ? o.output + ".checkpoint" : o.checkpoint,
                       folder / weights.stem()};
    check_writable(files.weights);
    if (!is_machine(o.network)) {
        check_writable(files.checkpoint);
        if (!o.resume && !o.afresh)
            check_no_checkpoint(files.checkpoint);
    } else if (o.resume) {
        throw usage_error(
            fmt::format("--resume: expected a network, found {}, which is trained in one go", o.network));
    }
    check_writable(files.reports.string() + ".confusion.csv");
    return files;
}

/// `training`: nothing for a machine, which has no learning curve.
void write_reports(const train_options& o, const std::filesystem::path& reports,
                   const network_training* training, const tactnet::confusion_matrix& test,
                   const std::vector<std::string>& classes) {
    const std::string title = fmt::format("{} {}x{}", o.network, o.training.rows, o.training.columns);
    make_folder_of(reports);
    if (training != nullptr) {
        tactnet::write_file(reports.string() + ".learning.jsonl",
                            learning_curve_json_lines(training->history()));
        plot_learning_curve(reports.string() + ".learning",
                            fmt::format("{}, {} recipe", title, o.training.recipe), training->history());
    }
    if (test.total() > 0)
        plot_confusion(reports.string() + ".confusion",
                       fmt::format("{}, {} split {}", title, o.split, o.seed), test, classes);
}

int train(const train_options& o) {
    const method& what = find_method(o.network, o.training.rows, o.training.columns);
    const tactnet::recipe recipe = recipe_for(o.network, o.training);
    const output_files files = files_for(o);
    const image_data data = load_data(o.data, o.training.rows, o.training.columns, o.training.resize);
    const std::vector<std::string>& classes = data.images.classes;
    check_capacity(what, o.data, classes.size());
    const tactnet::split_rule rule = split_rule_of(o.split);
    tactnet::data_split split =
        tactnet::split_data(data.images.labels, classes.size(), rule, o.seed, o.training.shares);
    const tactnet::file_metadata settings =
        describe_training(what, o.training, rule, o.seed, data.fingerprint);

    const auto from = load_start(what, o.training, classes);

    tactnet::thread_pool threads(o.threads);
    const auto training = what.train(recipe, data.view(), std::move(split), o.seed, threads);
    start(*training, from.get());
    auto* const epochs = dynamic_cast<network_training*>(training.get());
    const std::string size =
        epochs != nullptr ? fmt::format(" {} parameters:", grouped(what.costs(classes.size()).parameters))
                          : "";
    fmt::print(stderr, "{} {}x{}, {} classes,{} {} images to train, {} to validate, {} to test\n", o.network,
               what.rows, what.columns, classes.size(), size, training->split().training.size(),
               training->split().validation.size(), training->split().test.size());

    const stopwatch watch;
    if (epochs == nullptr)
        run_once(*training, o.data);
    else if (!run_epochs(*epochs, o, recipe.epochs, files.checkpoint, settings))
        return interrupted_by_user;
    const double seconds = watch.seconds();

    const auto best = training->best(classes);
    const tactnet::evaluation test = best->evaluate(data.view(), training->split().test, threads);
    const tactnet::evaluation validation = best->evaluate(data.view(), training->split().validation, threads);
    tactnet::file_metadata metadata = settings;
    if (epochs != nullptr)
        metadata["trained_epochs"] = fmt::to_string(epochs->history().size());
    if (test.confusion.total() > 0)
        metadata["test_accuracy"] = fmt::to_string(test.confusion.accuracy());
    if (validation.confusion.total() > 0)
        metadata["validation_accuracy"] = fmt::to_string(validation.confusion.accuracy());

    make_folder_of(files.weights);
    best->save(files.weights, metadata, selftest_images(o.selftest, what.rows, what.columns));
    write_reports(o, files.reports, epochs, test.confusion, classes);
    if (epochs != nullptr) { // a finished training has nothing to go on with
        std::error_code ignored;
        std::filesystem::remove(files.checkpoint, ignored);
    }

    fmt::print("{}: trained in {:.1f} s", files.weights.string(), seconds);
    if (test.confusion.total() > 0)
        fmt::print(", test accuracy {:.2f} % ({} of {})", 100 * test.confusion.accuracy(),
                   test.confusion.correct(), test.confusion.total());
    fmt::print("\n");
    return success;
}

} // namespace

command add_train(CLI::App& program) {
    auto* app = program.add_subcommand(
        "train", "Train a network or a support vector machine on a folder of images and save it");
    auto o = std::make_shared<train_options>();
    app->add_option("--data", o->data,
                    "Folder with one subfolder a class, each with 8-bit grey JPEG or PNG images")
        ->type_name("FOLDER")
        ->required();
    app->add_option("--network,--method", o->network, "One of " + method_names())
        ->type_name("NAME")
        ->capture_default_str();
    app->add_option("--output", o->output, "Weight file to write; curves and confusion matrix go beside it")
        ->type_name("FILE")
        ->required();
    add_training_options(*app, o->training);
    app->add_option("--split", o->split,
                    "'random', or 'blocked': neighbours in the order of recording stay together")
        ->check(CLI::IsMember({"random", "blocked"}))
        ->capture_default_str();
    app->add_option("--seed", o->seed,
                    "Of the split, the first weights and the order; any whole number from 0")
        ->type_name("N")
        ->check(CLI::NonNegativeNumber)
        ->capture_default_str();
    app->add_option("--threads", o->threads, "Threads, 1 to 1024; the result does not depend on it")
        ->capture_default_str()
        ->type_name("N")
        ->check(CLI::Range(1, 1024));
    app->add_option("--checkpoint", o->checkpoint,
                    "Where a stopped training is kept (default: OUTPUT.checkpoint)")
        ->type_name("FILE");
    app->add_option("--checkpoint-every", o->checkpoint_minutes,
                    "Minutes between checkpoints of a running training, above 0")
        ->type_name("MINUTES")
        ->check(CLI::PositiveNumber)
        ->capture_default_str();
    auto* resume =
        app->add_flag("--resume", o->resume, "Go on from the checkpoint, to the same bits as in one go");
    app->add_flag("--afresh", o->afresh, "Start anew though there is a checkpoint, and give that up")
        ->excludes(resume);
    app->add_option("--plots", o->plots,
                    "Folder for curves and confusion matrix (default: that of the weight file)")
        ->type_name("FOLDER");
    app->add_option(
           "--self-test", o->selftest,
           "Made-up images kept in the weight file with what came of them, 0 to 100; loading checks them")
        ->type_name("N")
        ->check(CLI::Range(0, 100))
        ->capture_default_str();
    return [o] { return train(*o); };
}
