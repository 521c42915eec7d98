#include "reports/pictures.hpp"

#include "console.hpp"
#include "files/output_files.hpp"
#include "reports/report.hpp"

#include <tactnet/io/write_file.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <map>
#include <memory>
#include <printable.hpp>
#include <spawn.h>
#include <string_view>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

namespace {

/// A file without a name, for a child's standard stream.
class nameless_file {
public:
    explicit nameless_file(std::string_view text = {}) : file_(std::tmpfile()) {
        if (file_ && !text.empty() &&
            std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size()) // not of a null pointer
            std::fflush(file_.get());
        if (file_)
            std::rewind(file_.get());
    }
    bool open() const { return file_ != nullptr; }
    int descriptor() const { return ::fileno(file_.get()); }
    /// All that the child has written.
    std::string text() {
        std::rewind(file_.get());
        std::string all;
        char some[65536];
        for (std::size_t count = 0; (count = std::fread(some, 1, sizeof(some), file_.get())) > 0;)
            all.append(some, count);
        return all;
    }

private:
    struct closer {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    std::unique_ptr<std::FILE, closer> file_;
};

bool is_whole(std::string_view bytes, std::string_view format) {
    using namespace std::string_view_literals;
    if (format == "svg")
        return bytes.starts_with("<?xml"sv) && bytes.ends_with("</svg>\n\n"sv);
    return bytes.starts_with("\x89PNG\r\n\x1A\n"sv) && bytes.ends_with("\0\0\0\0IEND\xAE\x42\x60\x82"sv);
}

/// The first of gnuplot's words that say what was wrong.
std::string first_line(std::string_view words) {
    while (!words.empty()) {
        std::string_view line = words.substr(0, words.find('\n'));
        words.remove_prefix(std::min(line.size() + 1, words.size()));
        line.remove_prefix(std::min(line.find_first_not_of(" \t^"), line.size()));
        if (!line.empty())
            return std::string(line);
    }
    return "";
}

drawn_picture not_run(int error) {
    return {{},
            error == ENOENT
                ? "gnuplot was not found"
                : fmt::format("gnuplot could not be run ('{}')", std::generic_category().message(error))};
}

/// A slash after each.
std::string joined(const std::vector<std::string>& names) {
    std::string all;
    for (const std::string& name : names)
        all += printable(name) + '/';
    return all;
}

/// A word of the shell.
std::string shell_word(std::string_view text) {
    std::string result = "'";
    for (const char c : printable(text))
        result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

} // namespace

drawn_picture draw(const std::string& script, const std::filesystem::path& csv, const std::string& format,
                   const picture_titles& titles) {
    // Files in place of pipes: neither side waits for the other.
    nameless_file in(embedded(script)), out, error;
    if (!in.open() || !out.open() || !error.open())
        return not_run(errno);
    std::vector<std::string> words{"gnuplot",
                                   "-c",
                                   "/dev/stdin",
                                   std::filesystem::absolute(csv).string(),
                                   format,
                                   printable(titles.title),
                                   joined(titles.names)};
    std::vector<char*> arguments;
    for (std::string& word : words)
        arguments.push_back(word.data());
    arguments.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    if (const int code = posix_spawn_file_actions_init(&actions); code != 0)
        return not_run(code);
    posix_spawn_file_actions_adddup2(&actions, in.descriptor(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, out.descriptor(), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, error.descriptor(), STDERR_FILENO);
    pid_t child = 0;
    const int code = posix_spawnp(&child, "gnuplot", &actions, nullptr, arguments.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    if (code != 0)
        return not_run(code);
    int status = 0;
    while (::waitpid(child, &status, 0) != child)
        if (errno != EINTR)
            return not_run(errno);
    drawn_picture result{out.text(), {}};
    if (WIFEXITED(status) && WEXITSTATUS(status) == 0 && is_whole(result.picture, format))
        return result;
    const std::string line = first_line(error.text());
    return {{}, "gnuplot did not draw it" + (line.empty() ? "" : " ('" + line + "')")};
}

void draw_picture(const std::string& script, const std::filesystem::path& stem, const std::string& csv,
                  const picture_titles& titles) {
    const auto file = [&](const char* ending) { return std::filesystem::path(stem) += ending; };
    const auto word = [&](const char* ending) { return shell_word("./" + file(ending).filename().string()); };
    make_folder_of(stem);
    tactnet::write_file(file(".csv"), csv);
    const drawn_picture drawn = draw(script, file(".csv"), "png", titles);
    std::error_code ignored;
    if (!drawn.picture.empty()) {
        tactnet::write_file(file(".png"), drawn.picture);
        std::filesystem::remove(file(".gp"), ignored);
        return;
    }
    std::filesystem::remove(file(".png"), ignored); // an earlier one would not fit the table
    tactnet::write_file(file(".gp"), embedded(script));
    tell("{} is not drawn: {}; in its folder, gnuplot -c {} {} png {} {} > {} draws it\n",
         printable(file(".png").string()), printable(drawn.problem), word(".gp"), word(".csv"),
         shell_word(titles.title), shell_word(joined(titles.names)), word(".png"));
}

std::string learning_curves_csv(std::span<const titled_curve> curves) {
    std::map<std::size_t, std::vector<const tactnet::epoch_report*>> epochs;
    for (std::size_t i = 0; i < curves.size(); ++i)
        for (const tactnet::epoch_report& e : curves[i].second) {
            epochs[e.epoch].resize(curves.size());
            epochs[e.epoch][i] = &e;
        }
    std::vector<nlohmann::ordered_json> rows;
    for (const auto& [epoch, reports] : epochs) {
        nlohmann::ordered_json& row = rows.emplace_back(nlohmann::ordered_json{{"epoch", epoch}});
        for (std::size_t i = 0; i < curves.size(); ++i) {
            const tactnet::epoch_report& e =
                reports[i] != nullptr ? *reports[i] : tactnet::epoch_report{.loss = std::nan("")};
            const std::string of = curves.size() > 1 ? fmt::format("{}: ", curves[i].first) : "";
            row[of + "loss"] = e.loss;
            row[of + "validation_loss"] = e.validation_loss;
            row[of + "validation_accuracy"] = e.validation_accuracy;
        }
    }
    return csv_of(rows);
}

void plot_learning_curves(const std::filesystem::path& stem, std::span<const titled_curve> curves) {
    picture_titles titles;
    for (const titled_curve& curve : curves)
        titles.names.push_back(curve.first);
    draw_picture("learning_curves.gnuplot", stem, learning_curves_csv(curves), titles);
}

std::string confusion_csv(const tactnet::confusion_matrix& confusion,
                          const std::vector<std::string>& classes) {
    std::string text = "true class";
    for (const std::string& name : classes)
        text += ',' + csv_field(printable(name)); // on one line, for gnuplot
    for (std::size_t truth = 0; truth < classes.size(); ++truth) {
        text += '\n' + csv_field(printable(classes[truth]));
        for (std::size_t recognised = 0; recognised < classes.size(); ++recognised)
            text += ',' + fmt::to_string(confusion.count(truth, recognised));
    }
    return text + '\n';
}

void plot_confusion(const std::filesystem::path& stem, const std::string& title,
                    const tactnet::confusion_matrix& confusion, const std::vector<std::string>& classes) {
    draw_picture(
        "confusion.gnuplot", stem, confusion_csv(confusion, classes),
        {fmt::format("{} ({} of {} right)", title, confusion.correct(), confusion.total()), classes});
}

std::string reliability_csv(const calibration& of) {
    std::vector<nlohmann::ordered_json> rows;
    for (std::size_t b = 0; b < tactnet::reliability_diagram::bin_count; ++b) {
        nlohmann::ordered_json& row = rows.emplace_back();
        const auto add = [&](const std::string& by, const tactnet::reliability_diagram::bin& bin) {
            const bool some = bin.count > 0;
            row[by + "_probability"] = some ? bin.mean_probability() : std::nan("");
            row[by + "_accuracy"] = some ? bin.accuracy() : std::nan("");
            row[by + "_count"] = bin.count;
        };
        add("softmax", of.before.bins()[b]);
        add("calibrated", of.after.bins()[b]);
    }
    return csv_of(rows);
}

void plot_reliability(const std::filesystem::path& stem, const std::string& title, const calibration& of) {
    draw_picture("reliability.gnuplot", stem, reliability_csv(of),
                 {fmt::format("{} (calibration error {:.1f} %, by the softmax {:.1f} %)", title,
                              100 * of.after.calibration_error(), 100 * of.before.calibration_error()),
                  {}});
}
