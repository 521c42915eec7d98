#include "reports/plot.hpp"

#include "console/standard_streams.hpp"
#include "methods/training_settings.hpp"
#include "reports/gnuplot.hpp"
#include "reports/report.hpp"

#include <tactnet/io/write_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <printable.hpp>
#include <system_error>
#include <utility>

namespace {

/// In single quotes, where nothing but the quote itself means anything; gnuplot wants it doubled.
std::string quoted(const std::string& text, const char* quote = "''") {
    std::string result = "'";
    for (const char c : printable(text))
        result += c == '\'' ? std::string(quote) : std::string(1, c);
    return result + "'";
}
/// A file of the folder one is in, as a word of the shell.
std::string shell_word(const std::filesystem::path& file) {
    return quoted("./" + file.filename().string(), "'\\''");
}

std::filesystem::path with_ending(std::filesystem::path stem, const char* ending) {
    stem += ending;
    return stem;
}

/// Writes data, and the picture that `body` plots. The script names no file: see draw_picture.
void draw(const std::filesystem::path& stem, const std::string& csv, const std::string& size,
          const std::string& body) {
    make_folder_of(stem);
    const auto script = with_ending(stem, ".gp"), picture = with_ending(stem, ".png");
    tactnet::write_file(with_ending(stem, ".csv"), csv);
    const std::string text =
        fmt::format("if (strstrt(GPVAL_TERMINALS, 'pngcairo') > 0) {{ set terminal pngcairo size {} }} "
                    "else {{ set terminal png size {} }}\n"
                    "set datafile separator ','\n"
                    "{}",
                    size, size, body);
    const drawn_picture drawn = draw_picture(text, picture_format::png);
    if (!drawn.picture.empty()) {
        tactnet::write_file(picture, drawn.picture);
        std::error_code ignored;
        std::filesystem::remove(script, ignored);
        return;
    }
    tactnet::write_file(script, text);
    tell("{} is not drawn: {}; in its folder, gnuplot < {} > {} draws it\n", printable(picture.string()),
         printable(drawn.problem), shell_word(script), shell_word(picture));
}

/// Lines of CSV as the data block $data.
std::string data_block(const std::string& csv) {
    return "$data << END\n" + csv + "END\n";
}

/// gnuplot takes _ and others for markup.
constexpr const char* plain_titles = "set title {} noenhanced\n";

} // namespace

void plot_learning_curve(const std::filesystem::path& stem, const std::string& title,
                         std::span<const tactnet::epoch_report> history) {
    const std::string csv = learning_curve_csv(history);
    std::string body = data_block(csv) + fmt::format(plain_titles, quoted(title)) +
                       "set xlabel 'epoch'\nset ylabel 'loss'\n";
    const bool validated =
        std::ranges::any_of(history, [](const auto& e) { return std::isfinite(e.validation_accuracy); });
    if (validated) // gnuplot refuses an axis without a value
        body += "set y2label 'validation accuracy, %'\nset ytics nomirror\nset y2tics\nset y2range [*:100]\n"
                "set key center right\nset grid x y2\n";
    else
        body += "set grid\n";
    body += "plot $data using 1:3 every ::1 with lines lw 2 title 'training loss'";
    if (validated)
        body += ", $data using 1:4 every ::1 with linespoints pt 7 ps 0.4 title 'validation loss', "
                "$data using 1:($5*100) every ::1 axes x1y2 with linespoints pt 7 ps 0.4 title 'validation "
                "accuracy'";
    draw(stem, csv, "900,600", body + "\n");
}

void plot_confusion(const std::filesystem::path& stem, const std::string& title,
                    const tactnet::confusion_matrix& confusion, const std::vector<std::string>& classes) {
    // Shares of the true class in colour, counts in figures; zeros are left out.
    std::string names, labels;
    const std::size_t count = classes.size();
    for (std::size_t c = 0; c < count; ++c)
        names += fmt::format("{}{} {}", c > 0 ? ", " : "", quoted(classes[c]), c);
    std::string cells = "$cells << END\n";
    for (std::size_t truth = 0; truth < count; ++truth) {
        std::size_t total = 0;
        for (std::size_t c = 0; c < count; ++c)
            total += confusion(truth, c);
        for (std::size_t c = 0; c < count; ++c) {
            const std::size_t n = confusion(truth, c);
            const double share = total > 0 ? static_cast<double>(n) / static_cast<double>(total) : 0;
            cells += fmt::format("{},{},{}\n", c, truth, share);
            if (n > 0)
                labels += fmt::format("set label '{}' at {},{} center front textcolor rgb '{}' font ',8'\n",
                                      n, c, truth, share > 0.5 ? "white" : "black");
        }
    }
    const std::size_t side = 260 + 34 * count;
    draw(stem, confusion_csv(confusion, classes), fmt::format("{},{}", side + 60, side),
         cells + "END\n" +
             fmt::format(plain_titles, quoted(fmt::format("{} ({} of {} right)", title, confusion.correct(),
                                                          confusion.total()))) +
             labels + fmt::format("set xrange [-0.5:{0}.5]\nset yrange [{0}.5:-0.5]\n", count - 1) +
             fmt::format("set xtics rotate by 60 right noenhanced ({0})\nset ytics noenhanced ({0})\n",
                         names) +
             "set xlabel 'recognised class'\nset ylabel 'true class'\nset size ratio 1\nset cbrange [0:1]\n"
             "set palette defined (0 'white', 1 'dark-blue')\nset cblabel 'share of the true class'\nunset "
             "key\n"
             "plot $cells using 1:2:3 with image\n");
}

void plot_costs(const std::filesystem::path& stem, std::span<const cost_point> points) {
    std::string csv = "network,multiply_adds,microseconds", lines, series;
    for (const cost_point& p : points) {
        const bool head = lines.empty();
        lines += fmt::format("{},{},{}", csv_field(p.name), p.multiply_adds, p.microseconds);
        for (std::size_t i = 0; i < p.accuracies.size(); ++i) {
            const auto& [rule, accuracy] = p.accuracies[i];
            lines += fmt::format(",{},{}", accuracy.mean, accuracy.deviation);
            if (!head)
                continue;
            csv += fmt::format(",{0}_accuracy,{0}_deviation", name_of(rule));
            // A little to the side, so that no error bar hides another.
            series += fmt::format(
                "$data using ($2*{}):(${}*100):(${}*100) every ::1 with yerrorbars pt {} title "
                "'{} splits', ",
                1 + 0.02 * static_cast<double>(i), 4 + 2 * i, 5 + 2 * i, i == 0 ? 7 : 5, name_of(rule));
        }
        lines += '\n';
    }
    csv += '\n' + lines;
    draw(stem, csv, "900,600",
         data_block(csv) +
             "set title 'what accuracy costs'\nset logscale x\nset xlabel 'multiply-adds a frame, all taps'\n"
             "set ylabel 'test accuracy, %'\nset key bottom right\nset grid\nset format x '10^{%L}'\nset "
             "offsets "
             "graph 0.2, graph 0.2, graph 0.1, graph 0.1\n"
             "plot " +
             series + "$data using 2:($4*100):1 every ::1 with labels noenhanced offset 0,1.2 notitle\n");
}
