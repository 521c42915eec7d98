#include "commands/epochs.hpp"

#include "data/regular_file.hpp"
#include "reports/printable.hpp"
#include "reports/progress.hpp"
#include "reports/report.hpp"
#include "usage_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <interrupt.hpp>
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

/// Tells whether it is done.
bool run(network_training& training, std::size_t epochs, const checkpoint_options& checkpoint,
         const tactnet::file_metadata& settings) {
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
        const double seconds = watch.seconds();
        line.show(progress_text(training.history(), epochs, training.images_per_epoch(), before, seconds),
                  training.finished());
        if (seconds - saved > 60 * checkpoint.minutes) {
            make_folder_of(checkpoint.path);
            training.save_checkpoint(checkpoint.path, settings);
            saved = seconds;
        }
    }
    return true;
}

} // namespace

void check_no_checkpoint(const std::filesystem::path& path) {
    std::error_code code;
    if (std::filesystem::is_regular_file(path, code))
        throw usage_error(fmt::format("{}: expected no checkpoint here, found one of an unfinished training; "
                                      "--resume goes on from it, --afresh gives it up, --checkpoint takes "
                                      "another name",
                                      path.string()));
}

bool run_epochs(network_training& training, std::size_t epochs, const checkpoint_options& checkpoint,
                const tactnet::file_metadata& settings) {
    if (checkpoint.resume)
        check_no_device(checkpoint.path), training.load_checkpoint(checkpoint.path, settings);
    catch_interrupts();
    if (run(training, epochs, checkpoint, settings))
        return true;
    make_folder_of(checkpoint.path);
    training.save_checkpoint(checkpoint.path, settings);
    fmt::print(stderr, "stopped after epoch {} of {}; the same command with --resume goes on from {}\n",
               training.history().size(), epochs, printable(checkpoint.path.string()));
    return false;
}
