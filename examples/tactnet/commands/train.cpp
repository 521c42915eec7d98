// tactnet train: one method on one split of a folder of images.

#include "commands/commands.hpp"
#include "console.hpp"
#include "data/image_data.hpp"
#include "data/input_file.hpp"
#include "evaluation/results.hpp"
#include "files/claims.hpp"
#include "files/output_files.hpp"
#include "methods/description.hpp"
#include "methods/registry.hpp"
#include "methods/weights.hpp"
#include "number_options.hpp"
#include "reports/pictures.hpp"
#include "reports/report.hpp"

#include <tactnet/io/checkpoint.hpp>
#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/text/numbers.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <interrupt.hpp>
#include <iterator>
#include <memory>
#include <stdexcept>
#include <stopwatch.hpp>
#include <string>
#include <system_error>
#include <vector>

namespace {

struct checkpoint_options {
    std::filesystem::path path;
    double minutes;                  ///< between checkpoints of a running training
    bool resume;                     ///< go on from the one that is there
    tactnet::file_metadata settings; ///< of the training
};

/// How far a training is that began `seconds` ago after `before` epochs.
std::string progress_text(const std::vector<tactnet::epoch_report>& history, std::size_t epochs,
                          std::size_t images, std::size_t before, double seconds) {
    const tactnet::epoch_report& e = history.back();
    const std::size_t done = e.epoch - before;
    std::string text = fmt::format("epoch {} of {}, loss {:.4f}", e.epoch, epochs, e.loss);
    const auto validated = std::find_if(history.rbegin(), history.rend(), [](const auto& past) {
        return !std::isnan(past.validation_accuracy);
    });
    if (validated != history.rend())
        text += fmt::format(", validation {:.1f} %", 100 * validated->validation_accuracy);
    return text + fmt::format(", {:.0f} images/s, {}", static_cast<double>(images * done) / seconds,
                              time_left(seconds, done, epochs - e.epoch));
}

/// Empty, or why the checkpoint could not be written.
std::string keep(network_training& training, const checkpoint_options& checkpoint) {
    try {
        make_folder_of(checkpoint.path);
        training.save_checkpoint(checkpoint.path, checkpoint.settings);
        return {};
    } catch (const std::runtime_error& error) {
        return error.what();
    }
}

/// Throws usage_error where there is one: hours of work may be in there. With `afresh` it is given up, and
/// only another file of that name is refused. A finished training removes its own.
void check_no_checkpoint(const std::filesystem::path& path, bool afresh) {
    std::error_code code;
    if (!std::filesystem::is_regular_file(path, code))
        return;
    if (!afresh)
        refuse("{}: expected no checkpoint here, found one of an unfinished training; --resume goes on from "
               "it, --afresh gives it up, --checkpoint takes another name",
               path.string());
    std::string format;
    try {
        const auto file = tactnet::safetensors_source::open(path, tactnet::checksum_rule::ignore);
        if (const auto found = file.metadata().find("format"); found != file.metadata().end())
            format = found->second;
    } catch (const tactnet::file_error&) { // someone else's file
    }
    if (format != "tactnet checkpoint")
        refuse("{}: expected a checkpoint, which --afresh gives up, found another file; --checkpoint takes "
               "another name",
               path.string());
}

/// Throws tactnet::file_error unless there is a checkpoint of a training with these settings.
void check_resumable(const checkpoint_options& checkpoint) {
    check_no_device(checkpoint.path);
    tactnet::check_checkpoint(checkpoint.path, checkpoint.settings);
}

/// Keeps a finished training whose results could not be written, and reports it.
void keep_unwritten(network_training& training, const checkpoint_options& checkpoint) {
    if (const std::string problem = keep(training, checkpoint); !problem.empty())
        tell("warning: no checkpoint of the finished training either ({})\n", printable(problem));
    else
        tell("the finished training is kept: the same command with --resume writes what comes of it, from "
             "{}\n",
             printable(checkpoint.path.string()));
}

/// Trains until done or interrupted; returns whether it is done.
bool run_epochs(network_training& training, std::size_t epochs, const checkpoint_options& checkpoint) {
    if (checkpoint.resume)
        if (training.load_checkpoint(checkpoint.path, checkpoint.settings) == tactnet::checksum_state::absent)
            tell("{}: no checksum in it, so that damage may go unnoticed\n",
                 printable(checkpoint.path.string()));
    catch_interrupts();
    progress line;
    const stopwatch watch;
    const std::size_t before = training.history().size();
    double saved = 0;
    while (!training.finished() && !interrupted()) {
        training.advance();
        const double seconds = watch.seconds();
        line.show(progress_text(training.history(), epochs, training.images_per_epoch(), before, seconds),
                  training.finished());
        if (seconds - saved <= 60 * checkpoint.minutes)
            continue;
        saved = seconds;
        if (const std::string problem = keep(training, checkpoint); !problem.empty()) {
            line.end_line();
            tell("warning: no checkpoint of epoch {} ({}); the training goes on\n", training.history().size(),
                 printable(problem));
        }
    }
    if (training.finished())
        return true;
    line.end_line();
    if (const std::string problem = keep(training, checkpoint); !problem.empty())
        refuse("stopped after epoch {} of {}, without a checkpoint of it: {}", training.history().size(),
               epochs, problem);
    tell("stopped after epoch {} of {}; the same command with --resume goes on from {}\n",
         training.history().size(), epochs, printable(checkpoint.path.string()));
    return false;
}

struct train_options {
    training_settings training;
    std::string data, method = default_method(), split = "random", output, checkpoint;
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
        tactnet::random_stream random(i, tactnet::random_purposes::order);
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

/// What a training leaves.
struct output_files {
    std::filesystem::path weights, checkpoint;
    std::filesystem::path reports; ///< how their names begin
    std::unique_ptr<claims> claimed{};
};

/// Throws usage_error where they cannot be written, or should not.
output_files files_for(const method& what, const train_options& o) {
    if (!what.is_network() && o.resume)
        refuse("--resume: expected a network, found {}, which is trained in one go", o.method);
    const std::filesystem::path weights = o.output;
    output_files files{weights, o.checkpoint.empty() ? o.output + ".checkpoint" : o.checkpoint,
                       weights.parent_path() / weights.stem()};
    const std::string reports = files.reports.string();
    std::vector<named_file> outputs{{"--output", files.weights}}, more;
    std::vector<named_file> claimed{{"--output", files.weights}, {"--output", reports + ".confusion"}};
    if (what.is_network()) {
        outputs.push_back({"--checkpoint", files.checkpoint});
        claimed.push_back(outputs.back());
        more = picture_files("--output", reports + ".learning");
    }
    std::ranges::move(picture_files("--output", reports + ".confusion"), std::back_inserter(more));
    std::ranges::move(more, std::back_inserter(outputs));
    check_regular(outputs);
    check_outputs({{"--start", o.training.start}, {"--pretrained", o.training.pretrained}}, outputs, o.data);
    files.claimed = std::make_unique<claims>();
    for (const auto& [of, path] : claimed)
        if (!files.claimed->take_soon(path))
            refuse("{}: expected a file that no other program is about to write, found another training at "
                   "work on {}",
                   of, printable(path.string()));
    if (what.is_network() && !o.resume)
        check_no_checkpoint(files.checkpoint, o.afresh);
    return files;
}

/// Tests and writes the result of a training. Returns a line about it.
std::string finish(const train_options& o, const output_files& files, const image_data& data,
                   const training_run& training, const method& what, tactnet::file_metadata metadata,
                   double seconds, tactnet::thread_pool& threads) {
    const std::vector<std::string>& classes = data.images.classes;
    const auto* const epochs = dynamic_cast<const network_training*>(&training);
    const auto trained = training.best(classes);
    const auto tested = [&](const trained_method& which) {
        return which.evaluate(data.view(), training.split().test, threads);
    };
    std::unique_ptr<trained_network> whole; // in 8 bits
    if (o.training.bits == 8)
        whole = in_eight_bits(*trained, data.view(), training.split().training);
    const trained_method* const best = whole ? whole.get() : trained.get();
    const tactnet::evaluation test = tested(*best);
    const tactnet::evaluation validation = best->evaluate(data.view(), training.split().validation, threads);
    if (const auto scaling = fit_temperature(validation, training.split().validation, data))
        metadata["temperature"] = tactnet::shortest_number(scaling->temperature);
    if (epochs != nullptr)
        metadata["trained_epochs"] = fmt::to_string(epochs->history().size());
    if (test.confusion.total() > 0)
        metadata["test_accuracy"] = fmt::to_string(test.confusion.accuracy());
    if (validation.confusion.total() > 0)
        metadata["validation_accuracy"] = fmt::to_string(validation.confusion.accuracy());

    make_folder_of(files.weights);
    best->save(files.weights, metadata, selftest_images(o.selftest, o.training.rows, o.training.columns));
    const std::string title = fmt::format("{} {}x{}", o.method, what.rows, what.columns),
                      reports = files.reports.string();
    if (epochs != nullptr) // a support vector machine has no learning curve
        plot_learning_curves(reports + ".learning",
                             fmt::format("{}, {} recipe", title, recipe_for(what, o.training).name),
                             epochs->history());
    if (test.confusion.total() > 0)
        plot_confusion(reports + ".confusion", fmt::format("{}, {} split {}", title, o.split, o.seed),
                       test.confusion, classes);
    std::error_code ignored; // a finished training has nothing to go on with
    if (epochs != nullptr)
        std::filesystem::remove(files.checkpoint, ignored);

    std::string line = fmt::format("{}: trained in {:.1f} s", printable(files.weights.string()), seconds);
    const auto accuracy = [](const tactnet::confusion_matrix& of) {
        return fmt::format("{:.2f} % ({} of {})", 100 * of.accuracy(), of.correct(), of.total());
    };
    if (test.confusion.total() > 0)
        line += ", test accuracy " + accuracy(test.confusion);
    if (test.confusion.total() > 0 && whole)
        line += fmt::format(" in 8 bits, {} in single precision", accuracy(tested(*trained).confusion));
    if (whole)
        line += "\nin 8 bits " + whole->calibration();
    return line + '\n';
}

/// Whether a file holds the weights of a training with these settings, to the last byte.
bool written(const std::filesystem::path& weights, const tactnet::file_metadata& settings) {
    try {
        const tactnet::safetensors file = tactnet::safetensors::read(weights);
        require_metadata(file, settings);
        return file.checksum() == tactnet::checksum_state::verified;
    } catch (const tactnet::file_error&) { // none, or half of one
        return false;
    }
}

/// Trains. Returns false if interrupted: the same command then continues.
bool run(training_run& training, const train_options& o, std::size_t epochs,
         const checkpoint_options& checkpoint) {
    if (auto* by_epochs = dynamic_cast<network_training*>(&training))
        return run_epochs(*by_epochs, epochs, checkpoint);
    try {
        training.advance();
    } catch (const std::invalid_argument& error) { // a single class, or nothing to describe
        refuse("{}: {}", o.data, error.what());
    }
    return !interrupted(); // which is looked at only where features were computed before
}

int train(const train_options& o) {
    const method& what = find_method(o.method, o.training.rows, o.training.columns);
    const tactnet::recipe recipe = recipe_for(what, o.training);
    const output_files files = files_for(what, o);
    const image_data data = load_data(o.data, o.training.rows, o.training.columns, o.training.resize);
    const std::vector<std::string>& classes = data.images.classes;
    check_capacity(what, o.data, classes.size());
    const tactnet::split_rule rule = split_rule_of(o.split);
    tactnet::data_split split =
        tactnet::split_data(data.images.labels, classes.size(), rule, o.seed, o.training.shares);
    const checkpoint_options checkpoint{files.checkpoint, o.checkpoint_minutes, o.resume,
                                        describe_training(what, o.training, rule, o.seed, data)};
    if (o.resume) // before anything is found that another training may have kept
        check_resumable(checkpoint);
    const auto from = load_start(what, o.training, classes);
    auto begins_with = open_pretrained(what, o.training);

    tactnet::thread_pool threads(o.threads);
    if (begins_with) {
        catch_interrupts();
        if (!begins_with->prepare(data, {}, threads)) {
            tell("stopped before the training\n");
            return interrupted_by_user;
        }
    }
    const auto training = what.train(recipe, data.view(), std::move(split), o.seed, threads, begins_with);
    begins_with.reset(); // the training has what it needs of it
    start(*training, from.get());
    const std::string size =
        what.is_network() ? fmt::format(" {} parameters:", grouped(what.learnable(classes.size()))) : "";
    tell("{} {}x{}, {} classes,{} {} images to train, {} to validate, {} to test\n", o.method, what.rows,
         what.columns, classes.size(), size, training->split().training.size(),
         training->split().validation.size(), training->split().test.size());
    const stopwatch watch;
    if (!run(*training, o, recipe.epochs, checkpoint))
        return interrupted_by_user;
    const double seconds = watch.seconds();
    std::string line;
    try {
        line = finish(o, files, data, *training, what, checkpoint.settings, seconds, threads);
    } catch (const tactnet::file_error&) { // a full disk, which may have room for it elsewhere
        if (written(files.weights, checkpoint.settings))
            tell("the weights are whole in {}; what failed is about them\n",
                 printable(files.weights.string()));
        else if (auto* by_epochs = dynamic_cast<network_training*>(training.get()))
            keep_unwritten(*by_epochs, checkpoint);
        throw;
    }
    print(line);
    return success;
}

} // namespace

command add_train(CLI::App& program) {
    auto* app = program.add_subcommand("train", "Train a network, the head of a pretrained one or a "
                                                "support vector machine on a folder of images");
    auto o = std::make_shared<train_options>();
    add_data_option(*app, o->data);
    app->add_option("--method", o->method, "One of " + method_names());
    app->add_option("--output", o->output,
                    "Weight file to write; learning curves and confusion matrix are written next to it")
        ->type_name("FILE")
        ->required();
    add_training_options(*app, o->training, "--pretrained,--weights");
    add_bits_option(*app, o->training.bits,
                    "Of a weight in the file: 32, single precision, or 8, with the ranges of maps from the "
                    "training images");
    app->add_option("--split", o->split,
                    "'random', or 'blocked': neighbours in the order of recording stay together")
        ->check(CLI::IsMember({"random", "blocked"}));
    app->add_option("--seed", o->seed, "Seed of the split, the initial weights and the order of images")
        ->check(seed());
    app->add_option("--threads", o->threads, "Number of threads; the result does not depend on it")
        ->check(whole_number(1, 1024));
    app->add_option("--checkpoint", o->checkpoint,
                    "File of the checkpoint of a stopped training (default: OUTPUT.checkpoint)");
    app->add_option("--checkpoint-every", o->checkpoint_minutes, "Minutes between checkpoints")
        ->check(positive_number());
    auto* resume =
        app->add_flag("--resume", o->resume,
                      "Continue from the checkpoint; the result is bit-identical to an uninterrupted run");
    app->add_flag("--afresh", o->afresh, "Start from the beginning and discard the checkpoint")
        ->excludes(resume);
    app->add_option("--self-test", o->selftest,
                    "Synthetic images stored in the weight file with their outputs; loading checks them")
        ->check(whole_number(0, 100));
    return [o] { return train(*o); };
}
