#include "reports/pictures.hpp"

#include "console.hpp"
#include "files/output_files.hpp"
#include "reports/report.hpp"

#include <tactnet/io/file_error.hpp>
#include <tactnet/io/write_file.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <string_view>
#include <sys/wait.h>
#include <system_error>
#include <utility>

namespace {

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
    for (const char c : text)
        result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

/// The command of the shell that writes a picture to the standard output.
std::string command_for(const std::string& script, const std::string& csv, const std::string& format,
                        const picture_titles& titles) {
    return fmt::format("gnuplot -c {} {} {} {} {}", shell_word(script), shell_word(csv), format,
                       shell_word(printable(titles.title)), shell_word(joined(titles.names)));
}

/// What a command of the shell writes to its standard output, and its exit status.
std::pair<std::string, int> output_of(const std::string& command) {
    std::FILE* const pipe = ::popen(command.c_str(), "r");
    if (pipe == nullptr)
        return {"", -1};
    std::string all;
    char some[65536];
    for (std::size_t count = 0; (count = std::fread(some, 1, sizeof(some), pipe)) > 0;)
        all.append(some, count);
    const int status = ::pclose(pipe);
    return {std::move(all), status != -1 && WIFEXITED(status) ? WEXITSTATUS(status) : -1};
}

} // namespace

drawn_picture draw(const std::string& script, const std::filesystem::path& csv, const std::string& format,
                   const picture_titles& titles) {
    const std::string command =
        command_for("/dev/stdin", std::filesystem::absolute(csv).string(), format, titles);
    const auto run = [&](const char* streams) {
        return output_of(
            fmt::format("{} {} <<'end of script'\n{}\nend of script\n", command, streams, embedded(script)));
    };
    auto [picture, status] = run("2>/dev/null");
    if (status == 0 && is_whole(picture, format))
        return {std::move(picture), {}};
    if (status == 127) // by convention of the shell
        return {{}, "gnuplot was not found"};
    const std::string line = first_line(run("2>&1 >/dev/null").first);
    return {{}, "gnuplot did not draw it" + (line.empty() ? "" : " ('" + line + "')")};
}

void draw_picture(const std::string& script, const std::filesystem::path& stem, const std::string& csv,
                  const picture_titles& titles) {
    const auto file = [&](const char* ending) { return std::filesystem::path(stem) += ending; };
    const auto name = [&](const char* ending) { return printable("./" + file(ending).filename().string()); };
    make_folder_of(stem);
    tactnet::write_file(file(".csv"), csv);
    drawn_picture drawn = draw(script, file(".csv"), "png", titles);
    std::error_code ignored;
    try {
        if (!drawn.picture.empty()) {
            tactnet::write_file(file(".png"), drawn.picture);
            std::filesystem::remove(file(".gp"), ignored);
            return;
        }
    } catch (const tactnet::file_error& error) { // a full disk, which may have room for the script
        drawn.problem = error.what();
    }
    std::filesystem::remove(file(".png"), ignored); // an earlier one would not fit the table
    tactnet::write_file(file(".gp"), embedded(script));
    tell("{} is not drawn: {}; in its folder, {} > {} draws it\n", printable(file(".png").string()),
         printable(drawn.problem), command_for(name(".gp"), name(".csv"), "png", titles),
         shell_word(name(".png")));
}

void plot_learning_curves(const std::filesystem::path& stem, const std::string& title,
                          std::span<const tactnet::epoch_report> history) {
    std::vector<nlohmann::ordered_json> rows;
    for (const tactnet::epoch_report& e : history)
        rows.push_back({{"epoch", e.epoch},
                        {"loss", e.loss},
                        {"validation_loss", e.validation_loss},
                        {"validation_accuracy", e.validation_accuracy}});
    draw_picture("learning_curves.gnuplot", stem, csv_of(rows), {title, {}});
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
