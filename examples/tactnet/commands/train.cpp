// tactnet train: one method on one split of a folder of images.

#include "commands/commands.hpp"
#include "data/input_file.hpp"
#include "files/claims.hpp"
#include "files/output_files.hpp"
#include "methods/description.hpp"
#include "methods/networks/compiled.hpp"
#include "methods/registry.hpp"
#include "methods/weights.hpp"
#include "reports/classes.hpp"
#include "reports/neighbours.hpp"
#include "reports/pictures.hpp"

#include <tactnet/io/checkpoint.hpp>
#include <tactnet/io/write_file.hpp>
#include <tactnet/text/numbers.hpp>

#include <cmath>
#include <interrupt.hpp>

namespace {

struct train_options {
    training_settings training;
    std::string data, method = default_method(), split, output, checkpoint;
    group_options groups;
    std::uint64_t seed = 0;
    std::size_t threads = 1; // more pay on an idle machine only: their barriers wait for every core
    std::size_t selftest = 4;
    double checkpoint_minutes = 5; ///< between those of a running training
    bool resume = false, afresh = false;
};

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
    try {
        const auto file = tactnet::safetensors_source::open(path, tactnet::checksum_rule::ignore);
        const auto format = file.metadata().find("format");
        if (format != file.metadata().end() && format->second == "tactnet checkpoint")
            return;
    } catch (const tactnet::file_error&) { // someone else's file
    }
    refuse("{}: expected a checkpoint, which --afresh gives up, found another file; --checkpoint takes "
           "another name",
           path.string());
}

/// The command at work.
class train_command {
public:
    explicit train_command(const train_options& options)
        : o(options),
          what(find_method(o.method, fmt::format("{}x{}", o.training.rows, o.training.columns))),
          recipe(recipe_for(what, o.training)),
          weights(o.output),
          checkpoint(o.checkpoint.empty() ? o.output + ".checkpoint" : o.checkpoint),
          reports((weights.parent_path() / weights.stem()).string()),
          threads(o.threads) {}

    int run() {
        check_files();
        data = load_data(o.data, what.rows, what.columns, o.training.images, o.groups);
        const std::size_t classes = data.images.classes.size();
        check_capacity(what, o.data, classes);
        rule = split_rule_for(o.split, data);
        settings = describe_training(what, o.training, rule, o.seed, data);
        searched = describe_trials(what, o.training, data);
        if (o.resume) { // before anything is found that another training may have kept
            check_no_device(checkpoint);
            tactnet::check_checkpoint(checkpoint, described());
            const auto kept = tactnet::safetensors_source::open(checkpoint); // undamaged
            trials = trials_in(kept);
            begun = kept.tensors().size() > 1; // not of the progress of no epoch alone
        }
        const auto from = load_start(what, o.training, data.images.classes);
        auto begins_with = open_pretrained(what, o.training);
        if (begins_with) {
            catch_interrupts();
            if (!begins_with->prepare(data, {}, threads)) {
                tell("stopped before the training\n");
                return interrupted_by_user;
            }
        }
        auto split = split_for(data, o.training, rule, o.seed);
        catch_interrupts();
        const auto choice = choose(split.training);
        if (interrupted()) {
            const std::string problem = begun || trials.empty() ? "" : keep();
            tell("stopped before the training{}\n",
                 !problem.empty()           ? fmt::format(", without a checkpoint: {}", printable(problem))
                 : begun || !trials.empty() ? fmt::format("; the same command with --resume goes on from {}",
                                                          printable(checkpoint.string()))
                                            : "");
            return interrupted_by_user;
        }
        recipe.epochs = choice.chosen.epochs;
        for (const auto& [key, value] : describe_method(what, choice.chosen))
            if (const auto said = settings.find(key); said == settings.end() || said->second != value)
                chosen["chosen_" + key] = value;
        for (const std::string& reason : choice.reasons)
            tell("augmentation: {}\n", printable(reason));
        training = what.train(choice.chosen, data.view(), std::move(split), o.seed, threads, begins_with);
        begins_with.reset(); // the training has what it needs of it
        epochs = dynamic_cast<epoch_training*>(training.get());
        start(*training, from.get());
        const auto& [train, validate, test] = training->split();
        tell("{} {}, {} classes,{} {} images to train, {} to validate, {} to test\n", o.method, what.size(),
             classes,
             epochs != nullptr ? fmt::format(" {} parameters:", grouped(what.costs(classes).parameters)) : "",
             train.size(), validate.size(), test.size());
        tell_neighbours(data, training->split());
        const stopwatch watch;
        if (!(epochs != nullptr ? run_epochs() : run_at_once()))
            return interrupted_by_user;
        finish(watch.seconds());
        return success;
    }

private:
    /// Throws usage_error where what it leaves cannot be written, or should not.
    void check_files() {
        if (!what.is_network() && o.resume)
            refuse("--resume: expected a network, found {}, which is trained in one go", o.method);
        std::vector<named_file> claimed{{"--output", weights}}, outputs;
        if (what.is_network())
            claimed.push_back({"--checkpoint", checkpoint});
        outputs = claimed;
        claimed.push_back({"--output", reports + ".confusion"});
        add_picture(outputs, "--output", reports + ".confusion");
        outputs.push_back({"--output", reports + ".predictions.csv"});
        if (what.is_network())
            add_picture(outputs, "--output", reports + ".learning");
        check_regular(outputs);
        check_outputs({{"--start", o.training.start}, {"--pretrained", o.training.pretrained}}, outputs,
                      o.data);
        for (const auto& [of, path] : claimed)
            if (!files.take_soon(path))
                refuse("{}: expected a file that no other program is about to write, found another training "
                       "at work on {}",
                       of, printable(path.string()));
        if (what.is_network() && !o.resume)
            check_no_checkpoint(checkpoint, o.afresh);
    }

    /// The settings with what images chose, and why, as a checkpoint has them.
    tactnet::file_metadata described() const {
        tactnet::file_metadata all = with_trials(settings, trials);
        all.insert(searched.begin(), searched.end());
        all.insert(chosen.begin(), chosen.end());
        return all;
    }

    /// Empty, or why the checkpoint could not be written: of the trials alone before the first epoch.
    std::string keep() const {
        try {
            make_folder_of(checkpoint);
            if (epochs != nullptr)
                epochs->save_checkpoint(checkpoint, described());
            else
                tactnet::save_checkpoint(checkpoint, {}, {}, described());
            return {};
        } catch (const std::runtime_error& error) {
            return error.what();
        }
    }

    /// Chooses the recipe, and shows the progress of the short trainings that do.
    tactnet::augmentation_choice choose(std::span<const std::size_t> images) {
        progress line;
        const stopwatch watch;
        std::size_t known = trials.size(), before = 0; // of the latter, epochs
        const auto stop = [&](std::size_t done, std::size_t all) {
            if (known > 0)
                --known, before = done;
            else if (done > before)
                line.show(fmt::format("short trainings: {} of {} epochs, {}", done, all,
                                      time_left(watch.seconds(), done - before, all - done)),
                          done == all);
            return interrupted();
        };
        return choose_recipe(what, o.training, data, images, o.seed, threads, stop, &trials);
    }

    /// How far a training is that began `seconds` ago after `before` epochs.
    std::string progress_text(std::size_t before, double seconds) const {
        const auto& history = epochs->history();
        const tactnet::epoch_report& e = history.back();
        const std::size_t done = e.epoch - before;
        std::string text = fmt::format("epoch {} of {}, loss {:.4f}", e.epoch, recipe.epochs, e.loss);
        const auto validated = std::find_if(history.rbegin(), history.rend(), [](const auto& past) {
            return !std::isnan(past.validation_accuracy);
        });
        if (validated != history.rend())
            text += fmt::format(", validation {:.1f} %", 100 * validated->validation_accuracy);
        return text + fmt::format(", {:.0f} images/s, {}",
                                  static_cast<double>(epochs->images_per_epoch() * done) / seconds,
                                  time_left(seconds, done, recipe.epochs - e.epoch));
    }

    /// Trains until done or interrupted; returns whether it is done.
    bool run_epochs() {
        if (begun && epochs->load_checkpoint(checkpoint, described()) == tactnet::checksum_state::absent)
            tell("{}: no checksum in it, so that damage may go unnoticed\n", printable(checkpoint.string()));
        catch_interrupts();
        progress line;
        const stopwatch watch;
        const std::size_t before = epochs->history().size();
        double saved = 0;
        while (!epochs->finished() && !interrupted()) {
            epochs->advance();
            const double seconds = watch.seconds();
            line.show(progress_text(before, seconds), epochs->finished());
            if (seconds - saved <= 60 * o.checkpoint_minutes)
                continue;
            saved = seconds;
            if (const std::string problem = keep(); !problem.empty()) {
                line.end_line();
                tell("warning: no checkpoint of epoch {} ({}); the training goes on\n",
                     epochs->history().size(), printable(problem));
            }
        }
        if (epochs->finished())
            return true;
        line.end_line();
        const std::size_t done = epochs->history().size();
        if (const std::string problem = keep(); !problem.empty())
            refuse("stopped after epoch {} of {}, without a checkpoint of it: {}", done, recipe.epochs,
                   problem);
        tell("stopped after epoch {} of {}; the same command with --resume goes on from {}\n", done,
             recipe.epochs, printable(checkpoint.string()));
        return false;
    }

    bool run_at_once() {
        try {
            training->advance();
        } catch (const std::invalid_argument& error) { // a single class, or nothing to describe
            refuse("{}: {}", o.data, error.what());
        }
        return !interrupted(); // which is looked at only where features were computed before
    }

    /// Tests and writes the result, and prints a line about it.
    void finish(double seconds) {
        const auto trained = training->best(data.images.classes);
        std::unique_ptr<trained_network> in_bytes;
        if (o.training.bits == 8)
            in_bytes = in_eight_bits(*trained, data.view(), training->split().training);
        const trained_method& best = in_bytes ? *in_bytes : *trained;
        const auto evaluated = [&](const trained_method& which, std::span<const std::size_t> images) {
            return which.evaluate(data.view(), images, threads);
        };
        const auto& [train, validate, test_images] = training->split();
        const tactnet::evaluation tested = evaluated(best, test_images);
        const tactnet::confusion_matrix& test = tested.confusion;
        const tactnet::evaluation validation = evaluated(best, validate);
        tactnet::file_metadata metadata = settings;
        metadata.insert(chosen.begin(), chosen.end());
        double temperature = 1;
        if (const auto scaling = fit_temperature(validation, validate, data)) {
            temperature = scaling->temperature;
            metadata["temperature"] = tactnet::shortest_number(temperature);
        }
        if (epochs != nullptr)
            metadata["trained_epochs"] = fmt::to_string(epochs->history().size());
        if (test.total() > 0)
            metadata["test_accuracy"] = fmt::to_string(test.accuracy());
        if (validation.confusion.total() > 0)
            metadata["validation_accuracy"] = fmt::to_string(validation.confusion.accuracy());
        write(best, metadata, tested, temperature);

        std::string line = fmt::format("{}: trained in {:.1f} s", printable(weights.string()), seconds);
        const auto accuracy = [](const tactnet::confusion_matrix& of) {
            return fmt::format("{:.2f} % ({} of {})", 100 * of.accuracy(), of.correct(), of.total());
        };
        if (test.total() > 0)
            line += ", test accuracy " + accuracy(test);
        if (test.total() > 0 && in_bytes)
            line += fmt::format(" in 8 bits, {} in single precision",
                                accuracy(evaluated(*trained, test_images).confusion));
        print(line + (in_bytes ? "\nin 8 bits " + in_bytes->calibration() : "") + '\n');
    }

    void write(const trained_method& best, const tactnet::file_metadata& metadata,
               const tactnet::evaluation& test, double temperature) const {
        bool written = false;
        try {
            make_folder_of(weights);
            best.save(weights, metadata, made_up_touches(o.selftest, {what.rows, what.columns}));
            written = true;
            const std::string title = o.method + " " + what.size();
            if (epochs != nullptr) // a support vector machine has no learning curve
                plot_learning_curves(reports + ".learning", fmt::format("{}, {} recipe", title, recipe.name),
                                     epochs->history());
            if (!test.recognised.empty()) {
                tactnet::write_file(reports + ".predictions.csv",
                                    predictions_csv(data, training->split().test, test, temperature));
                plot_confusion(reports + ".confusion",
                               fmt::format("{}, {} split {}", title, name_of(rule), o.seed), test.confusion,
                               data.images.classes);
            }
        } catch (const tactnet::file_error&) { // a full disk, which may have room for it elsewhere
            if (written)
                tell("the weights are whole in {}; what failed is about them\n", printable(weights.string()));
            else if (const std::string problem = epochs != nullptr ? keep() : ""; !problem.empty())
                tell("warning: no checkpoint of the finished training either ({})\n", printable(problem));
            else if (epochs != nullptr)
                tell("the finished training is kept: the same command with --resume writes what comes of it, "
                     "from {}\n",
                     printable(checkpoint.string()));
            throw;
        }
        std::error_code ignored; // a finished training has nothing to go on with
        if (epochs != nullptr)
            std::filesystem::remove(checkpoint, ignored);
    }

    const train_options& o;
    const method& what;
    tactnet::recipe recipe; ///< of the name and number of epochs; images choose the rest
    const std::filesystem::path weights, checkpoint;
    const std::string reports; ///< how their names begin
    claims files;
    tactnet::thread_pool threads;
    image_data data;
    tactnet::split_rule rule{};
    tactnet::file_metadata settings{}, chosen{}; ///< the latter: what images chose otherwise
    tactnet::file_metadata searched{};           ///< what it was that images chose from
    tactnet::trial_scores trials;                ///< of the search for the augmentation
    bool begun = false;                          ///< what is resumed has done more than trials
    std::unique_ptr<training_run> training;
    epoch_training* epochs = nullptr; ///< the same, of a network
};

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
    add_group_options(*app, o->groups);
    add_split_option(*app, o->split, "random");
    add_option(*app, "--seed", o->seed, whole_number(0),
               "Seed of the split, the initial weights and the order of images");
    add_option(*app, "--threads", o->threads, whole_number(1, 1024),
               "Number of threads; the result does not depend on it");
    app->add_option("--checkpoint", o->checkpoint,
                    "File of the checkpoint of a stopped training (default: OUTPUT.checkpoint)");
    add_option(*app, "--checkpoint-every", o->checkpoint_minutes, positive_number(),
               "Minutes between checkpoints");
    auto* resume =
        app->add_flag("--resume", o->resume,
                      "Continue from the checkpoint; the result is bit-identical to an uninterrupted run");
    app->add_flag("--afresh", o->afresh, "Start from the beginning and discard the checkpoint")
        ->excludes(resume);
    add_option(*app, "--self-test", o->selftest, whole_number(0, 100),
               "Synthetic images stored in the weight file with their outputs; loading checks them");
    return [o] { return train_command(*o).run(); };
}
