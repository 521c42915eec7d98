// tactnet evaluate --weights: a trained method on the test images of its split, or on all images of a
// folder.

#include "commands/evaluate.hpp"
#include "console/standard_streams.hpp"
#include "data/image_data.hpp"
#include "evaluation/calibration.hpp"
#include "evaluation/stored_split.hpp"
#include "files/output_files.hpp"
#include "reports/pictures.hpp"
#include "reports/report.hpp"
#include "study/timings.hpp"
#include "usage_error.hpp"

#include <tactnet/text/quoting.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <numeric>

namespace {

/// Throws tactnet::file_error unless the folder's classes are those of the weights.
void check_classes(const evaluate_options& o, const loaded_weights& weights,
                   const std::vector<std::string>& classes) {
    if (classes.size() != weights.classes.size())
        throw tactnet::file_error(
            o.data, "",
            fmt::format("{} classes, as {} tells apart", weights.classes.size(), o.weights.weights),
            fmt::to_string(classes.size()));
    const auto [expected, found] =
        std::mismatch(weights.classes.begin(), weights.classes.end(), classes.begin());
    if (weights.named && found != classes.end())
        throw tactnet::file_error(o.data, "",
                                  fmt::format("the classes of {}, of which number {} is {}",
                                              o.weights.weights, found - classes.begin(),
                                              tactnet::in_quotes(*expected)),
                                  tactnet::in_quotes(*found));
}

} // namespace

int evaluate_weights(const evaluate_options& o) {
    const std::filesystem::path stem =
        std::filesystem::path(o.results) /
        ("confusion_" + std::filesystem::path(o.weights.weights).stem().string());
    const std::filesystem::path reliability =
        stem.parent_path() / ("reliability_" + std::filesystem::path(o.weights.weights).stem().string());
    std::vector<named_file> outputs = picture_files("--results", stem);
    std::ranges::move(picture_files("--results", reliability), std::back_inserter(outputs));
    check_outputs({{"--weights", o.weights.weights}, {"--classes", o.weights.classes}}, outputs, o.data);
    tidy_folders_of(outputs);
    const loaded_weights weights = load_weights(o.weights);
    const method& what = *weights.what;
    const image_data data = load_data(o.data, what.rows, what.columns, o.training.resize);
    const std::vector<std::string>& classes = data.images.classes;
    check_classes(o, weights, classes);
    std::vector<std::size_t> chosen(data.images.size());
    if (o.images == "all")
        std::iota(chosen.begin(), chosen.end(), std::size_t{0});
    else
        chosen = stored_split(o.weights.weights, weights.metadata, o.data, data).test;
    if (chosen.empty())
        throw tactnet::file_error(o.weights.weights, "", "a split with test images, or --images all", "none");

    tactnet::thread_pool threads(o.jobs);
    const tactnet::evaluation result = weights.trained->evaluate(data.view(), chosen, threads);
    const std::size_t bits = weights.trained->bits();
    method_costs costs = what.costs(classes.size());
    if (bits == 8)
        costs.parameter_bytes = what.eight_bit_bytes(classes.size());
    const pinned here;
    const frame_latency times = measure_latency(what.make_work(bits), what.frames_together());
    plot_confusion(stem, o.weights.weights, result.confusion, classes);
    print(table({{"method", "size", "images", "right", "accuracy, %", "loss", "parameters", "multiply-adds",
                  "on pixels", "bytes", "µs/frame", "µs in batch"},
                 {what.name, fmt::format("{}x{}", what.rows, what.columns),
                  fmt::to_string(result.confusion.total()), fmt::to_string(result.confusion.correct()),
                  fmt::format("{:.2f}", 100 * result.confusion.accuracy()),
                  std::isnan(result.loss) ? "none" : fmt::format("{:.4f}", result.loss),
                  grouped(costs.parameters), grouped(costs.multiply_adds),
                  grouped(costs.multiply_adds_on_pixels), grouped(costs.parameter_bytes),
                  fmt::format("{:.1f}", times.median), fmt::format("{:.1f}", times.in_batch)}}));
    const calibration probabilities = calibration_of(result, chosen, data, weights.scaling);
    if (!result.logits.empty()) {
        plot_reliability(reliability, o.weights.weights, probabilities);
        table_cells cells{{"probabilities", "calibration error, %", "Brier score"}};
        const auto add = [&](const std::string& by, const tactnet::reliability_diagram& of) {
            cells.push_back({by, fmt::format("{:.2f}", 100 * of.calibration_error()),
                             fmt::format("{:.4f}", of.brier_score())});
        };
        add("of the softmax", probabilities.before);
        add(fmt::format("at temperature {:.3f}", weights.scaling.temperature), probabilities.after);
        print('\n' + table(cells));
    }
    return success;
}
