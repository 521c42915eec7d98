// tactnet evaluate: methods trained and tested on many splits, and what each costs. Or a weight file.

#include "commands/commands.hpp"
#include "methods/registry.hpp"
#include "methods/weights.hpp"
#include "reports/classes.hpp"
#include "reports/pictures.hpp"
#include "study/comparison.hpp"
#include "study/page.hpp"

#include <tactnet/io/write_file.hpp>
#include <tactnet/svm/feature_rows.hpp>

#include <cmath>

namespace {

struct evaluate_options : evaluation_options {
    training_settings training;
    weight_options weights;
    std::string images = "test";
    std::vector<std::string> methods, sizes;
    std::vector<double> shares; ///< of the training images, for a learning curve
    std::uint64_t first_seed = 0;
    bool afresh = false; ///< forget earlier results
};

/// "confusion_tactnet6_28x50" in the folder of results.
std::filesystem::path picture_stem(const evaluate_options& o, std::string_view kind, const candidate& c,
                                   std::size_t bits) {
    return std::filesystem::path(o.results) /
           fmt::format("{}_{}_{}{}", kind, c.what->name, c.what->size(), bits == 8 ? "_8bit" : "");
}

/// All that was asked for. Throws usage_error.
candidate_list candidates_of(const evaluate_options& o) {
    candidate_list chosen;
    std::vector<std::string> sizes = o.sizes;
    if (sizes.empty())
        sizes.push_back(fmt::format("{}x{}", o.training.rows, o.training.columns));
    for (const std::string& size : sizes)
        for (const std::string& name : o.methods) {
            candidate& c = chosen.emplace_back(candidate{&find_method(name, size), o.training});
            c.training.rows = c.what->rows, c.training.columns = c.what->columns;
        }
    // A setting for some of the methods is no mistake of the others.
    const bool pretrained = std::ranges::any_of(
                   chosen, [](const candidate& c) { return c.what->pretrained().has_value(); }),
               network = std::ranges::any_of(chosen, [](const candidate& c) { return c.what->is_network(); });
    for (candidate& c : chosen) {
        if (pretrained && !c.what->pretrained())
            c.training.pretrained.clear();
        if (network && !c.what->is_network())
            static_cast<epoch_settings&>(c.training) = {};
        static_cast<void>(recipe_for(*c.what, c.training));
    }
    return chosen;
}

/// Throws usage_error.
void check(const evaluate_options& o, const candidate_list& chosen) {
    const std::size_t splits = o.splits.value_or(o.usual_splits);
    if (splits - 1 > std::numeric_limits<std::uint64_t>::max() - o.first_seed)
        refuse("--seed, --splits: expected seeds below 2^64 for all splits, found {} of them from {} on",
               splits, o.first_seed);
    if (o.training.shares.test <= 0)
        refuse("--test: expected a share above 0, since accuracy is measured on these images, found 0");
    std::set<std::filesystem::path> pictures; // a method may be named twice
    for (const candidate& c : chosen)
        for (const std::size_t bits : bits_of(c))
            for (const std::string_view kind : {"confusion", "reliability", "classes", "predictions"})
                if (kind != "reliability" || c.what->is_network())
                    pictures.insert(picture_stem(o, kind, c, bits));
    if (!o.shares.empty())
        pictures.insert(std::filesystem::path(o.results) / "learning_curve");
    check_study_files(o.results, {"table.jsonl", "table.csv", "intervals.csv", "intervals.jsonl"}, pictures,
                      {{"--start", o.training.start}, {"--pretrained", o.training.pretrained}}, o.data,
                      chosen);
}

void report(const evaluate_options& o, const candidate_list& candidates, const std::vector<task>& tasks,
            const std::vector<study_row>& rows) {
    const std::filesystem::path folder = o.results;
    auto row = rows.begin(); // one for each candidate and format
    for (const candidate& c : candidates)
        for (const std::size_t bits : bits_of(c)) {
            const std::string title =
                fmt::format("{}, {} {} splits", title_of(*row), number(*row, shown_rule(rows), "splits"),
                            name_of(shown_rule(rows)));
            plot_confusion(picture_stem(o, "confusion", c, bits), title, row->confusion, row->classes);
            write_class_report(picture_stem(o, "classes", c, bits), row->confusion, row->classes);
            if (const std::size_t missing =
                    write_predictions(picture_stem(o, "predictions", c, bits) += ".csv", c, bits, tasks))
                tell("{}: the predictions of {} trainings were not kept; --afresh makes them\n", c.what->name,
                     missing);
            if (row->probabilities)
                plot_reliability(picture_stem(o, "reliability", c, bits), title, *row->probabilities);
            ++row;
        }
    write_rows(rows, folder, "table");
    draw_study_pictures(rows, folder);
    for (const study_table& t : {methods_table(rows), details_table(rows), probabilities_table(rows)})
        if (t.cells.size() > 1)
            print(table(without_empty_columns(t.cells)) + '\n');
    print("accuracy: test images, mean ± standard deviation (splits); µs: this machine, one core\n");
}

int evaluate(const evaluate_options& o) {
    candidate_list candidates = candidates_of(o);
    check(o, candidates);
    const split_plan plan = load_candidates(candidates, o, o.first_seed);
    const std::filesystem::path list = std::filesystem::path(o.results) / "evaluation.jsonl";
    if (o.afresh) {
        std::error_code ignored;
        std::filesystem::remove(list, ignored);
    }
    result_list results(list);
    candidate_list parts; // of a learning curve, which ends with the candidates themselves
    for (candidate& c : candidates) {
        for (const double share : o.shares)
            parts.push_back(c), parts.back().training.share = share;
        c.predictions = std::filesystem::path(o.results) / "predictions";
    }
    std::vector<task> all = tasks_of(candidates, plan);
    const std::vector<task> of_parts = tasks_of(parts, plan);
    all.insert(all.end(), of_parts.begin(), of_parts.end());
    for (const task& t : all)
        if (std::error_code ignored; o.afresh)
            std::filesystem::remove(trials_of(t, results), ignored);
    if (o.elsewhere)
        static_cast<void>(take_from_elsewhere(all, results, false)); // which warns of them
    if (!train_all(all, o.jobs, results))
        return interrupted_by_user;
    report_intervals(candidates, plan, all, results);
    std::vector<const candidate*> curve;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        for (std::size_t s = 0; s < o.shares.size(); ++s)
            curve.push_back(&parts[i * o.shares.size() + s]);
        curve.push_back(&candidates[i]);
    }
    if (!parts.empty())
        report_learning_curve(curve, plan, all, results);
    stay_on_this_core();
    report(o, candidates, all,
           rows_of(candidates, plan, all, results,
                   [](const method& what, std::size_t bits) { return measure_latency(what, bits); }));
    return success;
}

/// Puts the labels of a folder, which may lack classes, among the classes of the weights. Throws usage_error
/// for other classes.
void take_classes(const evaluate_options& o, const loaded_weights& weights, image_data& data) {
    tactnet::image_set& images = data.images;
    if (!weights.named && images.classes.size() != weights.classes.size())
        refuse("{}: expected {} classes, as {} tells apart, found {}", o.data, weights.classes.size(),
               o.weights.weights, images.classes.size());
    if (!weights.named)
        return;
    std::vector<std::size_t> place_of;
    for (const std::string& name : images.classes) {
        const auto known = std::ranges::find(weights.classes, name);
        if (known == weights.classes.end())
            refuse("{}: expected the classes of {}, of which number 0 is {}, found {}", o.data,
                   o.weights.weights, tactnet::in_quotes(weights.classes.front()), tactnet::in_quotes(name));
        place_of.push_back(static_cast<std::size_t>(known - weights.classes.begin()));
    }
    for (std::size_t& label : images.labels)
        label = place_of[label];
    images.classes = weights.classes;
}

/// Tests a weight file instead of training: on the test images of its split, or on all images of a folder.
int evaluate_weights(const evaluate_options& o) {
    const auto stem = [&](const char* kind) {
        return std::filesystem::path(o.results) /
               (kind + std::filesystem::path(o.weights.weights).stem().string());
    };
    std::vector<named_file> outputs;
    for (const char* kind : {"confusion_", "reliability_"})
        add_picture(outputs, "--results", stem(kind));
    for (const char* kind : {"classes_", "predictions_"})
        outputs.push_back({"--results", stem(kind) += ".csv"});
    outputs.push_back({"--results", stem("classes_") += ".jsonl"});
    check_outputs({{"--weights", o.weights.weights}, {"--classes", o.weights.classes}}, outputs, o.data);
    const loaded_weights weights = load_weights(o.weights);
    const method& what = *weights.what;
    image_data data = load_data(o.data, what.rows, what.columns, o.training.images, o.groups);
    take_classes(o, weights, data);
    const std::vector<std::string>& classes = data.images.classes;
    tactnet::data_split split;
    if (o.images == "all")
        split.test = tactnet::all_samples(data.images.size());
    else
        split = stored_split(o.weights.weights, weights.metadata, o.data, data);
    const std::vector<std::size_t>& chosen = split.test;
    if (chosen.empty())
        refuse("{}: expected a split with test images, or --images all, found none", o.weights.weights);

    tactnet::thread_pool threads(o.jobs);
    const tactnet::evaluation result = weights.trained->evaluate(data.view(), chosen, threads);
    plot_confusion(stem("confusion_"), o.weights.weights, result.confusion, classes);
    write_class_report(stem("classes_"), result.confusion, classes);
    tactnet::write_file(stem("predictions_") += ".csv",
                        predictions_csv(data, chosen, result, weights.trained->temperature()));
    print(table({{"method", "size", "images", "right", "accuracy, %", "loss"},
                 {what.name, what.size(), fmt::to_string(result.confusion.total()),
                  fmt::to_string(result.confusion.correct()),
                  fmt::format("{:.2f}", 100 * result.confusion.accuracy()),
                  std::isnan(result.loss) ? "none" : fmt::format("{:.4f}", result.loss)}}) +
          '\n' + table(class_table(result.confusion, classes)));
    if (result.logits.empty())
        return success;
    study_row row = make_row(what.name, what.rows, what.columns, "", weights.trained->bits());
    put_calibration(row, calibration_of(result, chosen, data, {weights.trained->temperature()}));
    plot_reliability(stem("reliability_"), o.weights.weights, *row.probabilities);
    const study_table t = probabilities_table({row});
    if (t.cells.size() > 1)
        print('\n' + table(without_empty_columns(t.cells)));
    return success;
}

/// What options for trainings say about a weight file.
void take_weight_options(const CLI::App& app, evaluate_options& o) {
    if (!o.training.pretrained.empty())
        refuse("--pretrained: expected a training, found --weights, whose file holds all that it needs");
    if (o.training.bits == 8)
        refuse("--bits: expected a training, found --weights, whose file says itself of how many bits its "
               "weights are");
    o.weights.images = o.training.images;
    if (!o.sizes.empty())
        refuse("--sizes: expected a training, found --weights, whose file says itself of what size it is");
    if (o.methods.size() > 1)
        refuse("--method: expected one method for one weight file, found {}", o.methods.size());
    if (!o.methods.empty())
        o.weights.method = o.methods.front();
    if (app.count("--rows") > 0)
        o.weights.rows = o.training.rows;
    if (app.count("--columns") > 0)
        o.weights.columns = o.training.columns;
}

} // namespace

command add_evaluate(CLI::App& program) {
    auto* app =
        program.add_subcommand("evaluate", "Train and test methods on many splits, or test a weight file");
    auto o = std::make_shared<evaluate_options>();
    add_evaluation_options(*app, *o);
    app->add_option(
           "--method", o->methods,
           fmt::format("Methods, separated by commas: {} (default: {})", method_names(), default_method()))
        ->delimiter(',');
    add_training_options(*app, o->training);
    app->add_option(
           "--sizes", o->sizes,
           "Sizes, such as 28x50,14x25, in place of --rows and --columns; images of another size need "
           "--resize")
        ->delimiter(',');
    app->add_option("--learning-curve", o->shares,
                    "Also train on shares of the training images, such as 0.125,0.25,0.5, of each class or, "
                    "if the split is by groups, whole groups, and draw accuracy against their number")
        ->delimiter(',')
        ->check(share())
        ->check(positive_number());
    add_bits_option(*app, o->training.bits,
                    "8: each training also as a network in 8 bits, with the ranges of maps from its training "
                    "images");
    add_option(*app, "--seed", o->first_seed, whole_number(0), "Seed of the first split; the others follow");
    app->add_flag("--afresh", o->afresh,
                  "Discard the finished trainings in that folder, for example after a change of the library");
    add_weight_options(*app, o->weights, false);
    add_option(*app, "--images", o->images, CLI::IsMember({"test", "all"}),
               "With --weights: the 'test' images of the split it was trained on, or 'all'");
    return [o, app] {
        if (o->weights.weights.empty()) {
            if (o->methods.empty())
                o->methods = {default_method()};
            return evaluate(*o);
        }
        take_weight_options(*app, *o);
        return evaluate_weights(*o);
    };
}
