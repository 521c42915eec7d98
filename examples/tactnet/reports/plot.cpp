#include "reports/plot.hpp"

#include "methods/training_settings.hpp"
#include "reports/report.hpp"
#include "reports/standard_streams.hpp"

#include <tactnet/io/file.hpp>

#include <fmt/format.h>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace {

/// In gnuplot's single quotes, where nothing but the quote itself means anything.
std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text)
        result += c == '\'' ? std::string("''") : std::string(1, c == '\n' ? ' ' : c);
    return result + "'";
}

/// Runs gnuplot in the script's folder; tells whether it ran and was content.
bool run_gnuplot(const std::filesystem::path& script, const std::string& output) {
    std::string program = "gnuplot", option = "-e", setting = "picture=" + quoted(output);
    std::string name = script.filename().string(), folder = script.parent_path().string();
    char* arguments[] = {program.data(), option.data(), setting.data(), name.data(), nullptr};
    posix_spawn_file_actions_t actions;
    if (posix_spawn_file_actions_init(&actions) != 0)
        return false;
    if (!folder.empty())
        posix_spawn_file_actions_addchdir_np(&actions, folder.c_str());
    posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    const int error = posix_spawnp(&child, program.c_str(), &actions, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&actions);
    int status = 0;
    return error == 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

std::filesystem::path with_ending(std::filesystem::path stem, const char* ending) {
    stem += ending;
    return stem;
}

/// Writes data and script, and draws. `body` plots from the file `data`.
void draw(const std::filesystem::path& stem, const std::string& csv, const std::string& size,
          const std::string& body) {
    make_folder_of(stem);
    const auto script = with_ending(stem, ".gp"), picture = with_ending(stem, ".png");
    const auto partial = with_ending(stem, ".png.partial");
    tactnet::write_file(with_ending(stem, ".csv"), csv);
    tactnet::write_file(
        script,
        fmt::format("if (!exists('picture')) picture = {}\n"
                    "data = {}\n"
                    "if (strstrt(GPVAL_TERMINALS, 'pngcairo') > 0) {{ set terminal pngcairo size {} }} "
                    "else {{ set terminal png size {} }}\n"
                    "set output picture\n"
                    "set datafile separator ','\n"
                    "{}unset output\n",
                    quoted(picture.filename().string()),
                    quoted(with_ending(stem, ".csv").filename().string()), size, size, body));
    std::error_code ignored;
    if (run_gnuplot(script, partial.filename().string())) {
        std::filesystem::rename(partial, picture, ignored);
        std::filesystem::remove(script, ignored);
        return;
    }
    std::filesystem::remove(partial, ignored);
    tell("gnuplot could not be run: no {}; draw it with 'gnuplot {}' in its folder\n",
         picture.filename().string(), script.filename().string());
}

/// gnuplot takes _ and others for markup.
constexpr const char* plain_titles = "set title {} noenhanced\n";

} // namespace

void plot_learning_curve(const std::filesystem::path& stem, const std::string& title,
                         std::span<const tactnet::epoch_report> history) {
    draw(stem, learning_curve_csv(history), "900,600",
         fmt::format(plain_titles, quoted(title)) +
             "set xlabel 'epoch'\nset ylabel 'loss'\nset y2label 'validation accuracy, %'\n"
             "set ytics nomirror\nset y2tics\nset y2range [*:100]\nset key center right\nset grid x y2\n"
             "plot data using 1:3 every ::1 with lines lw 2 title 'training loss', "
             "data using 1:4 every ::1 with linespoints pt 7 ps 0.4 title 'validation loss', "
             "data using 1:($5*100) every ::1 axes x1y2 with linespoints pt 7 ps 0.4 title 'validation "
             "accuracy'\n");
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
                "data using ($2*{}):(${}*100):(${}*100) every ::1 with yerrorbars pt {} title "
                "'{} splits', ",
                1 + 0.02 * static_cast<double>(i), 4 + 2 * i, 5 + 2 * i, i == 0 ? 7 : 5, name_of(rule));
        }
        lines += '\n';
    }
    draw(stem, csv + '\n' + lines, "900,600",
         "set title 'what accuracy costs'\nset logscale x\nset xlabel 'multiply-adds a frame, all taps'\n"
         "set ylabel 'test accuracy, %'\nset key bottom right\nset grid\nset format x '10^{%L}'\nset offsets "
         "graph 0.2, graph 0.2, graph 0.1, graph 0.1\n"
         "plot " +
             series + "data using 2:($4*100):1 every ::1 with labels noenhanced offset 0,1.2 notitle\n");
}
