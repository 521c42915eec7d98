#include "commands/epochs.hpp"

#include "console/progress.hpp"
#include "console/standard_streams.hpp"
#include "data/input_file.hpp"
#include "files/output_files.hpp"
#include "usage_error.hpp"

#include <tactnet/io/checkpoint.hpp>
#include <tactnet/io/safetensors/source.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <interrupt.hpp>
#include <printable.hpp>
#include <string>
#include <system_error>
#include <vector>

namespace {

/// How far a training is that began `seconds` ago after `before` epochs.
std::string progress_text(const std::vector<tactnet::epoch_report>& history, std::size_t epochs,
                          std::size_t images, std::size_t before, double seconds) {
    const tactnet::epoch_report& e = history.back();
    const double done = static_cast<double>(e.epoch - before);
    const double left = seconds / done * static_cast<double>(epochs - e.epoch);
    std::string text = fmt::format("epoch {} of {}, loss {:.4f}", e.epoch, epochs, e.loss);
    const auto validated = std::find_if(history.rbegin(), history.rend(), [](const auto& past) {
        return !std::isnan(past.validation_accuracy);
    });
    if (validated != history.rend())
        text += fmt::format(", validation {:.1f} %", 100 * validated->validation_accuracy);
    return text + fmt::format(", {:.0f} images/s, {} left", static_cast<double>(images) * done / seconds,
                              duration_text(left));
}

/// Empty, or why the checkpoint could not be written.
std::string keep(network_training& training, const checkpoint_options& checkpoint) {
    try {
        make_folder_of(checkpoint.path);
        training.save_checkpoint(checkpoint.path, checkpoint.settings);
        return {};
    } catch (const tactnet::file_error& error) {
        return error.what();
    } catch (const usage_error& error) {
        return error.what();
    }
}

} // namespace

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

void check_resumable(const checkpoint_options& checkpoint) {
    check_no_device(checkpoint.path);
    tactnet::check_checkpoint(checkpoint.path, checkpoint.settings);
}

void keep_unwritten(network_training& training, const checkpoint_options& checkpoint) {
    if (const std::string problem = keep(training, checkpoint); !problem.empty())
        tell("warning: no checkpoint of the finished training either ({})\n", printable(problem));
    else
        tell("the finished training is kept: the same command with --resume writes what comes of it, from "
             "{}\n",
             printable(checkpoint.path.string()));
}

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
