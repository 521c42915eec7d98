#include "study/page/learning_curves.hpp"

#include "methods/training_settings.hpp"
#include "study/page/gnuplot_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace {

/// The most accurate with a curve of each method, the best first.
std::vector<const study_row*> shown_of(const std::vector<study_row>& rows, tactnet::split_rule rule) {
    std::vector<const study_row*> known;
    for (const study_row& row : rows)
        if (!row.curve.empty() && find_accuracy(row, rule) != nullptr)
            known.push_back(&row);
    std::ranges::stable_sort(known, std::ranges::greater(),
                             [&](const study_row* row) { return find_accuracy(*row, rule)->test.mean; });
    std::vector<const study_row*> shown;
    for (const study_row* row : known)
        if (std::ranges::find(shown, row->method, [](const study_row* s) { return s->method; }) ==
            shown.end())
            shown.push_back(row);
    shown.resize(std::min<std::size_t>(shown.size(), 6));
    return shown;
}

/// gnuplot passes over what is no number.
std::string number(double value) {
    return std::isfinite(value) ? fmt::to_string(value) : "?";
}

} // namespace

study_picture learning_curves_picture(const std::vector<study_row>& rows) {
    const tactnet::split_rule rule = shown_rule(rows);
    const std::vector<const study_row*> shown = shown_of(rows, rule);
    if (shown.empty())
        return {};
    std::string data, losses, accuracies;
    std::size_t longest = 0, shortest = shown.front()->curve.back().epoch;
    for (std::size_t i = 0; i < shown.size(); ++i) {
        std::string lines;
        for (const tactnet::epoch_report& e : shown[i]->curve)
            lines += fmt::format("{} {} {} {}\n", e.epoch, number(e.loss), number(e.validation_loss),
                                 number(100 * e.validation_accuracy));
        data += gnuplot_data(fmt::format("curve{}", i), lines);
        losses += fmt::format("{0}$curve{1} using 1:2 with lines lw 1.5 dt 2 lc {2} notitle, "
                              "$curve{1} using 1:3 with lines lw 1.5 lc {2} notitle",
                              i == 0 ? "" : ", ", i, i + 1);
        accuracies += fmt::format("{}$curve{} using 1:4 with lines lw 1.5 lc {} title '{}'",
                                  i == 0 ? "" : ", ", i, i + 1, title_of(*shown[i]));
        longest = std::max(longest, shown[i]->curve.back().epoch);
        shortest = std::min(shortest, shown[i]->curve.back().epoch);
    }
    return {
        "learning_curves",
        fmt::format("Loss (dashed: on training images, as they are augmented; solid: on validation images) "
                    "and accuracy on validation images, epoch by epoch; the mean over {} splits.",
                    name_of(rule)),
        data + std::string(gnuplot_style) + "set datafile missing '?'\nset multiplot layout 1,2\n" +
            (longest > 4 * shortest ? "set logscale x\n" : "") +
            "set xlabel 'epoch'\nset ylabel 'loss'\nset logscale y\nplot " + losses +
            "\nunset logscale y\nset ylabel 'accuracy on validation images, %'\n"
            "set yrange [:100]\nset key bottom right\nplot " +
            accuracies + "\nunset multiplot\n"};
}
