#include "study/page/pictures.hpp"

#include "console/standard_streams.hpp"
#include "methods/training_settings.hpp"
#include "reports/gnuplot.hpp"
#include "study/page/accuracy_axis.hpp"
#include "study/page/gnuplot_text.hpp"
#include "study/page/learning_curves.hpp"

#include <tactnet/io/write_file.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <printable.hpp>
#include <set>
#include <string_view>
#include <system_error>
#include <utility>

namespace {

using tactnet::split_rule;

// Hues that people who confuse colours tell apart, on light and dark ground; grey for the paper.
constexpr std::string_view of_touches = "#2a78d6", of_photographs = "#d9622b", machines = "#199e70",
                           of_peers = "#b0479a", of_paper = "#8a8a86";

struct family {
    std::string_view title, colour;
    method_family which;
};
constexpr std::array families{
    family{"networks for touches", of_touches, method_family::touches},
    family{"networks from photographs", of_photographs, method_family::photographs},
    family{"support vector machines", machines, method_family::machines},
};

/// For bars, which names of points may cross.
std::string pale(std::string_view colour) {
    return fmt::format("#a0{}", colour.substr(1)); // in front of red stands how much shines through
}

bool has_paper(const std::vector<study_row>& rows) {
    return std::ranges::any_of(rows, [](const study_row& row) { return row.published != nullptr; });
}

/// What the pointer is told; no quotes, which would end gnuplot's text.
std::string words_of(const study_row& row) {
    std::string text =
        fmt::format("{} {}x{}, {} recipe", method_title(row), row.rows, row.columns, row.recipe);
    for (const auto& a : row.accuracies)
        text += fmt::format("\\n{:.2f} ± {:.2f} %, {} {} splits", 100 * a.test.mean, 100 * a.test.deviation,
                            a.splits, name_of(a.rule));
    if (row.latency)
        text += fmt::format("\\n{:.1f} µs a frame", row.latency->median);
    if (!row.declaration.empty())
        text += "\\n" + row.declaration;
    return text;
}

accuracy_axis axis_of(const std::vector<study_row>& rows, split_rule rule) {
    accuracy_axis axis;
    for (const study_row& row : rows)
        if (const auto* a = find_accuracy(row, rule))
            axis.add(100 * a->test.mean, 100 * a->test.deviation);
    if (has_paper(rows))
        for (const published_result& p : published_results)
            axis.add(p.accuracy, p.deviation);
    return axis;
}

/// A line for each peer's time of a network that the rows have.
std::string peer_lines(const std::vector<study_row>& rows, const std::vector<peer_time>& peers,
                       split_rule rule) {
    std::string lines;
    for (const peer_time& peer : peers) {
        const study_row* same = nullptr;
        double best = 0;
        for (const study_row& row : rows)
            if (const auto* a = find_accuracy(row, rule);
                a != nullptr && row.bits == peer.bits && row.method == peer.method && row.rows == peer.rows &&
                row.columns == peer.columns && a->test.mean > best) {
                same = &row;
                best = a->test.mean;
            }
        if (same != nullptr)
            lines +=
                fmt::format("{} {} \"{} {}x{} by {}\\n{:.1f} µs a frame\"\n", peer.microseconds, 100 * best,
                            method_title(*same), peer.rows, peer.columns, peer.peer, peer.microseconds);
    }
    return lines;
}

/// Accuracy against microseconds: each method, the front, other libraries, and the paper.
study_picture costs_picture(const std::vector<study_row>& rows, const std::vector<peer_time>& peers) {
    const split_rule rule = shown_rule(rows);
    const accuracy_axis axis = axis_of(rows, rule);
    std::string data, plot;
    double fastest = 1e6;
    for (const family& f : families) {
        std::string lines;
        for (const study_row& row : rows)
            if (const auto* a = find_accuracy(row, rule);
                a != nullptr && row.latency && row.family == f.which) {
                const double mean = 100 * a->test.mean, deviation = 100 * a->test.deviation;
                lines += fmt::format("{} {} {} {} \"{}\"\n", row.latency->median, mean, mean - deviation,
                                     std::min(axis.last(), mean + deviation), words_of(row));
                fastest = std::min(fastest, row.latency->median);
            }
        if (lines.empty())
            continue;
        const std::string name = fmt::format("family{}", &f - families.data());
        data += gnuplot_data(name, lines);
        plot += fmt::format("${0} using 1:2:3:4 with yerrorbars pt 7 ps 0 lc rgb '{1}' notitle, "
                            "${0} using 1:2 with points pt 7 ps 0.8 lc rgb '{2}' title '{3}', "
                            "${0} using 1:2:5 with labels hypertext point pt 7 ps 0.8 lc rgb '{2}' notitle, ",
                            name, pale(f.colour), f.colour, f.title);
    }
    const std::string others = peer_lines(rows, peers, rule);
    if (!others.empty()) {
        data += gnuplot_data("peers", others);
        plot += fmt::format(
            "$peers using 1:2 with points pt 2 ps 0.8 lc rgb '{0}' title 'the same by other libraries', "
            "$peers using 1:2:3 with labels hypertext point pt 2 ps 0.8 lc rgb '{0}' notitle, ",
            of_peers);
    }
    std::string paper, front, labels;
    for (const published_result& p : published_results)
        if (p.seconds > 0 && has_paper(rows)) {
            paper += fmt::format("{} {} {} {} \"the paper: {}\\n{:.2f} ± {:.2f} %, {:.0f} ms an image\"\n",
                                 1e6 * p.seconds, p.accuracy, p.accuracy - p.deviation,
                                 p.accuracy + p.deviation, p.title, p.accuracy, p.deviation, 1e3 * p.seconds);
        }
    data += gnuplot_data("paper", paper);
    const auto best = pareto_front(rows, rule);
    double labelled = 2; // from the top, each well below the one before, so that none covers another
    for (auto row = best.rbegin(); row != best.rend(); ++row) {
        const double accuracy = 100 * find_accuracy(**row, rule)->test.mean;
        front = fmt::format("{} {}\n", (*row)->latency->median, accuracy) + front;
        if (labelled - axis.height(accuracy) < 0.04)
            continue;
        labels += fmt::format("{} {} \"{}\"\n", (*row)->latency->median, accuracy, title_of(**row));
        labelled = axis.height(accuracy);
    }
    if (!front.empty()) {
        data += gnuplot_data("front", front) + gnuplot_data("names", labels);
        plot =
            fmt::format("$front using 1:2 with steps lw 1.5 dt 2 lc rgb '{}' title 'the best for the time', ",
                        of_touches) +
            plot + "$names using 1:2:3 with labels right offset -0.8,0.5 font ',10' notitle, ";
    }
    plot += fmt::format("$paper using 1:2:3:4 with yerrorbars pt 6 ps 0 lc rgb '{1}' notitle, "
                        "$paper using 1:2 with points pt 6 ps 0.8 lc rgb '{0}' title 'the paper', "
                        "$paper using 1:2:5 with labels hypertext point pt 6 ps 0.8 lc rgb '{0}' notitle",
                        of_paper, pale(of_paper));
    return {"accuracy_and_time",
            fmt::format("Test accuracy over {} splits against the time of a frame on one core; bars are "
                        "standard deviations. "
                        "The paper's figures are of its own images and machine.{}",
                        name_of(rule),
                        others.empty() ? "" : " A cross is the same network, run by another library."),
            data + std::string(gnuplot_style) + axis.text() +
                fmt::format("set logscale x\nset xrange [{}:3e8]\nset xlabel 'time of a frame, one core'\n",
                            0.015 * fastest) +
                "set xtics ('1 µs' 1, '10 µs' 10, '100 µs' 1e2, '1 ms' 1e3, '10 ms' 1e4, '100 ms' 1e5, "
                "'1 s' 1e6, '10 s' 1e7, '100 s' 1e8)\nset key bottom right\nplot " +
                plot + '\n'};
}

/// Accuracy against the number of tactels, of methods that were tried at several sizes.
study_picture sizes_picture(const std::vector<study_row>& rows) {
    const split_rule rule = shown_rule(rows);
    std::map<std::string, std::string> lines;
    std::map<std::string, std::size_t> counts;
    std::set<std::size_t> tactels;
    for (const study_row& row : rows)
        if (const auto* a = find_accuracy(row, rule)) {
            const std::string name = fmt::format("{}, {}", method_title(row), row.recipe);
            lines[name] += fmt::format("{} {} {} \"{}\"\n", row.rows * row.columns, 100 * a->test.mean,
                                       100 * a->test.deviation, words_of(row));
            ++counts[name];
            tactels.insert(row.rows * row.columns);
        }
    std::string data, plot;
    std::size_t series = 0;
    for (const auto& [name, text] : lines) {
        if (counts[name] < 2)
            continue;
        data += gnuplot_data(fmt::format("series{}", series), text);
        plot +=
            fmt::format("$series{0} using 1:2:3 smooth unique with lines lw 1.5 lc {1} notitle, "
                        "$series{0} using 1:2:3 with yerrorbars pt {2} ps 0.8 lc {1} title '{3}', "
                        "$series{0} using 1:2:4 with labels hypertext point pt {2} ps 0.8 lc {1} notitle, ",
                        series, series + 1, 4 + series % 10, name);
        ++series;
    }
    if (series == 0)
        return {};
    std::string paper;
    for (const published_result& p : published_results)
        if (p.method == "tactnet6" && has_paper(rows)) {
            paper += fmt::format("{} {} {}\n", p.rows * p.columns, p.accuracy, p.deviation);
            tactels.insert(p.rows * p.columns);
        }
    data += gnuplot_data("paper", paper);
    plot += fmt::format("$paper using 1:2:3 with yerrorbars pt 6 ps 0.8 lc rgb '{0}' title 'TactNet-6 in the "
                        "paper', $paper using 1:2 with lines dt 2 lc rgb '{0}' notitle",
                        of_paper);
    const accuracy_axis axis = axis_of(rows, rule);
    return {"accuracy_and_tactels",
            fmt::format("Test accuracy over {} splits against the number of tactels.", name_of(rule)),
            data + std::string(gnuplot_style) + axis.text() +
                fmt::format("set logscale x\nset xrange [{}:{}]\nset xlabel 'tactels'\nset xtics ({})\n",
                            0.8 * static_cast<double>(*tactels.begin()),
                            1.25 * static_cast<double>(*tactels.rbegin()), fmt::join(tactels, ", ")) +
                "set key bottom right\nplot " + plot + '\n'};
}

} // namespace

std::vector<study_picture> study_pictures(const std::vector<study_row>& rows,
                                          const std::vector<peer_time>& peers) {
    std::vector<study_picture> pictures{costs_picture(rows, peers)};
    if (study_picture sizes = sizes_picture(rows); !sizes.name.empty())
        pictures.push_back(std::move(sizes));
    if (study_picture curves = learning_curves_picture(rows); !curves.name.empty())
        pictures.push_back(std::move(curves));
    return pictures;
}

std::string draw_study_picture(const study_picture& picture, const std::filesystem::path& folder) {
    const auto path = folder / (picture.name + ".png");
    std::error_code ignored; // what another study has left would not fit its tables
    std::filesystem::remove(path, ignored);
    const drawn_picture png = draw_picture(
        "if (strstrt(GPVAL_TERMINALS, 'pngcairo') > 0) { set terminal pngcairo size 1100,700 font ',11' } "
        "else { set terminal png size 1100,700 }\n" +
            picture.script,
        picture_format::png);
    if (png.picture.empty())
        tell("{} is not drawn: {}\n", printable(path.string()), printable(png.problem));
    else
        tactnet::write_file(path, png.picture);
    return draw_picture("set terminal svg size 900,600 dynamic font 'sans-serif,13'\n" + picture.script,
                        picture_format::svg)
        .picture;
}
