#include "reports/pictures.hpp"

#include "console.hpp"
#include "files/output_files.hpp"
#include "reports/report.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/write_file.hpp>

#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <system_error>
#if !defined(_WIN32)
#include <sys/wait.h>
#endif

namespace {

bool is_whole_png(std::string_view bytes) {
    using namespace std::string_view_literals;
    return bytes.starts_with("\x89PNG\r\n\x1A\n"sv) && bytes.ends_with("\0\0\0\0IEND\xAE\x42\x60\x82"sv);
}

/// The first line with words; gnuplot's start with a mark of the place.
std::string first_line(std::string_view words) {
    const std::size_t begin = std::min(words.find_first_not_of(" \t\n^"), words.size());
    words.remove_prefix(begin);
    return std::string(words.substr(0, words.find('\n')));
}

/// A word of the shell.
std::string shell_word(std::string_view text) {
    std::string result = "'";
    for (const char c : text)
        result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

/// What a command of the shell writes to its standard output, and its exit status.
std::pair<std::string, int> output_of([[maybe_unused]] const std::string& command) {
#if defined(_WIN32) // whose shell is another
    return {"", 127};
#else
    std::FILE* const pipe = ::popen(command.c_str(), "r");
    if (pipe == nullptr)
        return {"", -1};
    std::string all;
    char some[65536];
    for (std::size_t count = 0; (count = std::fread(some, 1, sizeof(some), pipe)) > 0;)
        all.append(some, count);
    const int status = ::pclose(pipe);
    return {std::move(all), status != -1 && WIFEXITED(status) ? WEXITSTATUS(status) : -1};
#endif
}

} // namespace

bool draw_picture(const std::string& script, const std::filesystem::path& stem, const std::string& csv,
                  const std::string& title, const std::vector<std::string>& names) {
    const auto file = [&](const char* ending) { return std::filesystem::path(stem) += ending; };
    std::string slashed;
    for (const std::string& name : names)
        slashed += name + '/';
    make_folder_of(stem);
    tactnet::write_file(file(".csv"), csv);
    const auto run = [&](const char* streams) {
        return output_of(fmt::format(
            "gnuplot -c /dev/stdin {} {} {} {} <<'end of script'\n{}\nend of script\n",
            shell_word(std::filesystem::absolute(file(".csv")).string()), shell_word(printable(title)),
            shell_word(printable(slashed)), streams, gnuplot_scripts.at(script)));
    };
    const auto [picture, status] = run("2>/dev/null");
    std::string problem = "gnuplot was not found";
    try {
        if (status == 0 && is_whole_png(picture)) {
            tactnet::write_file(file(".png"), picture);
            return true;
        }
        if (status != 127) { // which the shell returns for an unknown command
            const std::string line = first_line(run("2>&1 >/dev/null").first);
            problem = "gnuplot did not draw it" + (line.empty() ? "" : " ('" + line + "')");
        }
    } catch (const tactnet::file_error& error) { // a full disk
        problem = error.what();
    }
    std::error_code ignored;
    std::filesystem::remove(file(".png"), ignored); // an earlier one would not fit the table
    tell("{} is not drawn: {}; its numbers are in {}\n", printable(file(".png").string()), printable(problem),
         printable(file(".csv").string()));
    return false;
}

void plot_learning_curves(const std::filesystem::path& stem, const std::string& title,
                          std::span<const tactnet::epoch_report> history) {
    std::vector<nlohmann::ordered_json> rows;
    for (const tactnet::epoch_report& e : history)
        rows.push_back({{"epoch", e.epoch},
                        {"loss", e.loss},
                        {"validation_loss", e.validation_loss},
                        {"validation_accuracy", e.validation_accuracy}});
    draw_picture("learning_curves", stem, csv_of(rows), title);
}

void plot_confusion(const std::filesystem::path& stem, const std::string& title,
                    const tactnet::confusion_matrix& confusion, const std::vector<std::string>& classes) {
    std::string text = "true class";
    for (const std::string& name : classes)
        text += ',' + csv_field(printable(name)); // on one line, for gnuplot
    for (std::size_t truth = 0; truth < classes.size(); ++truth) {
        text += '\n' + csv_field(printable(classes[truth]));
        for (std::size_t recognised = 0; recognised < classes.size(); ++recognised)
            text += ',' + fmt::to_string(confusion.count(truth, recognised));
    }
    std::vector<std::string> labels(classes.size());
    for (std::size_t c = 0; c < classes.size(); ++c)
        for (const char letter : classes[c]) // a slash ends a name, and % begins a number in gnuplot's labels
            labels[c] += letter == '/' ? "∕" : std::string(letter == '%' ? 2 : 1, letter);
    draw_picture("confusion", stem, text + '\n',
                 fmt::format("{} ({} of {} right)", title, confusion.correct(), confusion.total()), labels);
}

void plot_reliability(const std::filesystem::path& stem, const std::string& title, const calibration& of) {
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
    draw_picture("reliability", stem, csv_of(rows),
                 fmt::format("{} (calibration error {:.1f} %, by the softmax {:.1f} %)", title,
                             100 * of.after.calibration_error(), 100 * of.before.calibration_error()));
}
