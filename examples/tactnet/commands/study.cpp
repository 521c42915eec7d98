// tactnet study: the paper's experiments again, and what they cost in time, on one page.

#include "commands/commands.hpp"
#include "console.hpp"
#include "evaluation/trainings.hpp"
#include "files/claims.hpp"
#include "files/output_files.hpp"
#include "methods/registry.hpp"
#include "methods/training_settings.hpp"
#include "number_options.hpp"
#include "reports/pictures.hpp"
#include "study/page.hpp"
#include "study/pictures.hpp"
#include "study/rows.hpp"

#include <tactnet/io/write_file.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <interrupt.hpp>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

namespace {

struct study_options {
    std::string data, results = "study", shard;
    std::vector<std::string> methods, sizes, recipes{"default", "published"}, pretrained, merged;
    std::string split = "both";
    std::size_t splits = 20, jobs = std::max(1U, std::thread::hardware_concurrency());
    std::size_t bits = 8;    ///< 8: networks in 8 bits too, where they have such a form
    std::size_t unknown = 0; ///< see training_settings
    bool report_only = false, only_trained = false;
};

bool chosen(const std::vector<std::string>& wanted, const std::string& name) {
    return wanted.empty() || std::ranges::find(wanted, name) != wanted.end();
}

/// "squeezenet=FILE" by its name. Throws usage_error.
std::map<std::string, std::string, std::less<>> pretrained_files(const study_options& o) {
    std::map<std::string, std::string, std::less<>> files;
    for (const std::string& text : o.pretrained) {
        const std::size_t middle = text.find('=');
        const std::string name = text.substr(0, middle);
        if (middle == std::string::npos ||
            std::ranges::none_of(photograph_networks::all, [&](const auto& n) { return n.name == name; }))
            refuse("--pretrained: expected a network and its file, such as "
                   "squeezenet=FILE, found '{}'",
                   text);
        files[name] = text.substr(middle + 1);
    }
    return files;
}

/// What is tried, and what cannot be.
struct study_plan {
    candidate_list candidates;
    std::vector<study_row> missing;   ///< for want of a pretrained network
    std::vector<study_row> not_built; ///< of the paper
};

/// Every method of the program at every size, and those of the paper that it lacks. Throws usage_error.
study_plan plan_of(const study_options& o) {
    const auto files = pretrained_files(o);
    study_plan plan;
    for (const auto& m : all_methods()) {
        const std::string size = fmt::format("{}x{}", m->rows, m->columns);
        if (!chosen(o.methods, m->name) || !chosen(o.sizes, size))
            continue;
        training_settings settings;
        settings.rows = m->rows, settings.columns = m->columns;
        settings.resize = true;
        if (const auto needed = m->pretrained()) {
            const auto file = files.find(needed->network.name);
            if (file == files.end()) {
                plan.missing.push_back(
                    {.method = m->name,
                     .rows = m->rows,
                     .columns = m->columns,
                     .recipe = "default",
                     .missing = fmt::format("needs {} trained on photographs, --pretrained {}=FILE",
                                            needed->network.title, needed->network.name),
                     .published = find_published(m->name, m->rows, m->columns)});
                continue;
            }
            settings.pretrained = file->second;
        }
        std::vector<std::string> tried; // recipes that come to the same
        for (const std::string& recipe : o.recipes) {
            if ((recipe == "published" && !(m->is_network() && m->published)) ||
                (recipe == "thorough" && !may_be_thorough(*m)))
                continue;
            settings.recipe = recipe;
            settings.bits = o.bits == 8 && m->has_eight_bit_form() ? 8 : 32;
            settings.unknown = may_be_thorough(*m) ? o.unknown : 0;
            const std::string name(recipe_for(*m, settings).name);
            if (std::ranges::find(tried, name) != tried.end())
                continue;
            tried.push_back(name);
            plan.candidates.push_back({m.get(), settings, nullptr});
        }
    }
    const bool for_touches = std::ranges::any_of(all_methods(), [](const auto& m) {
        return m->is_network() && find_published(m->name, m->rows, m->columns) != nullptr;
    });
    for (const published_result& p : published_results) // a program of other networks has no use for them
        if (for_touches && p.rows == 28 && chosen(o.methods, std::string(p.method)) &&
            chosen(o.sizes, "28x50") && std::ranges::none_of(all_methods(), [&](const auto& m) {
                return m->name == p.method && m->rows == p.rows && m->columns == p.columns;
            }))
            plan.not_built.push_back(
                {.method = std::string(p.method),
                 .rows = p.rows,
                 .columns = p.columns,
                 .recipe = "default",
                 .missing = fmt::format("the program was built without it, {}",
                                        p.method.ends_with("-svm") && p.method != "surf-svm"
                                            ? "TACTNET_PROGRAM_TRUNKS or _SIZES"
                                            : "TACTNET_PROGRAM_NETWORKS or _SIZES"),
                 .published = &p});
    return plan;
}

/// One part of all trainings, for a machine among several.
struct shard {
    std::size_t index = 0, count = 1;

    /// Whether it has the i-th of all trainings. Each part gets some splits by each rule of every method,
    /// since these take unlike times.
    bool has(std::size_t i, const split_plan& plan, std::size_t candidates) const {
        const std::size_t rules = plan.rules.size(), rule = i % rules, candidate = i / rules % candidates,
                          split = i / rules / candidates;
        return (split + candidate + rule) % count == index;
    }
};

shard shard_of(const std::string& text) {
    if (text.empty())
        return {};
    const std::size_t slash = std::min(text.find('/'), text.size());
    const auto index = whole_number_of(std::string_view(text).substr(0, slash)),
               count = whole_number_of(std::string_view(text).substr(std::min(slash + 1, text.size())));
    if (!index || !count || *index < 1 || *index > *count ||
        text.find_first_not_of("0123456789/") != text.npos)
        refuse("--shard: expected a part of all such as 1/4, from 1 on, found '{}'", text);
    return {*index - 1, *count};
}

/// Takes over what other folders of results have.
void merge(const study_options& o, result_list& results) {
    for (const std::string& folder : o.merged) {
        const auto path = std::filesystem::path(folder) / "evaluation.jsonl";
        if (!std::filesystem::exists(path))
            refuse("--merge: expected a folder of results, found no {}", path.string());
        std::size_t taken = 0;
        const result_list others(path);
        for (const auto& [settings, result] : others.all())
            if (results.find(settings) == nullptr) {
                results.add(result);
                ++taken;
            }
        tell("{} trainings taken from {}\n", taken, printable(path.string()));
    }
}

/// What is timed: methods, with weights of so many bits.
using timed_form = std::pair<const method*, std::size_t>;

std::vector<timed_form> forms_of(const candidate_list& candidates) {
    std::vector<timed_form> forms;
    for (const candidate& c : candidates)
        for (const std::size_t bits : bits_of(c))
            if (std::ranges::find(forms, timed_form(c.what, bits)) == forms.end())
                forms.emplace_back(c.what, bits);
    return forms;
}

/// For a report that trains nothing: trainings of other versions and instruction sets take the place of those
/// that this program has not made. Returns which, in words.
std::string take_from_elsewhere(std::vector<task>& tasks, const result_list& results) {
    std::set<std::string> programs;
    std::size_t count = 0;
    for (task& t : tasks) {
        const training_result* found = results.find_elsewhere(t.settings);
        if (found == nullptr) // in 8 bits it was not
            found = results.find_elsewhere(in_single_precision(t.settings));
        if (found == nullptr || results.find(t.settings) != nullptr)
            continue;
        for (const char* key : {"library", "instruction_set"})
            t.settings[key] = found->settings.at(key);
        programs.insert(
            fmt::format("tactnet {} for {}", t.settings["library"], t.settings["instruction_set"]));
        ++count;
    }
    return count == 0
               ? ""
               : fmt::format("{} of {} trainings are by {}", count, tasks.size(), fmt::join(programs, ", "));
}

std::string text_of(const tactnet::file_metadata& program) {
    return fmt::format("{}, {}, {}; tactnet {}", program.at("processor"), program.at("compiler"),
                       program.at("instruction_set"), program.at("library"));
}

/// Says what a report that trains and times nothing has, and lacks.
void tell_found(const candidate_list& candidates, const std::vector<task>& all, const result_list& results,
                const timing_list& timings) {
    const auto forms = forms_of(candidates);
    const auto trained =
        std::ranges::count_if(all, [&](const task& t) { return results.find(t.settings) != nullptr; });
    const auto timed = std::ranges::count_if(
        forms, [&](const timed_form& form) { return timings.find(*form.first, form.second) != nullptr; });
    tell("{}{} of {} trainings are there, {} of {} methods are timed\n",
         trained < std::ssize(all) || timed < std::ssize(forms) ? "warning: " : "", trained, all.size(),
         timed, forms.size());
}

/// False if interrupted.
bool time_all(const candidate_list& candidates, timing_list& timings, const std::filesystem::path& folder) {
    claims alone; // methods that are timed at once disturb each other
    if (!wait_until([&] { return alone.take(folder / "timings"); },
                    "waiting for another program that times methods for this folder"))
        return false;
    timings.read_on();
    const pinned here;
    std::vector<timed_form> missing = forms_of(candidates);
    std::erase_if(missing,
                  [&](const timed_form& form) { return timings.find(*form.first, form.second) != nullptr; });
    progress line;
    for (std::size_t i = 0; i < missing.size(); ++i) {
        if (interrupted()) {
            line.end_line();
            return false;
        }
        const auto& [form, bits] = missing[i];
        const method& what = *form;
        const frame_latency found = measure_latency(what.make_work(bits), what.frames_together());
        timings.add(what, bits, found);
        line.show(fmt::format("{} of {} methods timed: {} {}x{}{}, {:.1f} µs", i + 1, missing.size(),
                              what.name, what.rows, what.columns, bits == 8 ? " in 8 bits" : "",
                              found.median),
                  i + 1 == missing.size());
    }
    return true;
}

void report(const std::filesystem::path& folder, const std::vector<study_row>& rows,
            const report_subject& of) {
    tactnet::write_file(folder / "study.jsonl", study_json_lines(rows));
    tactnet::write_file(folder / "study.csv", study_csv(rows));
    const auto drawn = draw_study_pictures(study_pictures(rows), folder);
    tactnet::write_file(folder / "study.md", study_markdown(rows, of));
    tactnet::write_file(folder / "study.html", study_page(rows, drawn, of));
    if (const study_row* best = most_accurate(rows, shown_rule(rows)))
        plot_confusion(folder / "confusion", title_of(*best), best->confusion, best->classes);
    const study_table methods = methods_table(rows);
    print(table(without_empty_columns(methods.cells)) + methods.notes);
    tell("the page: {}\n", printable((folder / "study.html").string()));
}

/// Throws usage_error.
void check(const study_options& o, const study_plan& plan) {
    std::vector<named_file> inputs;
    for (const auto& [name, file] : pretrained_files(o))
        inputs.push_back({"--pretrained", file});
    check_study_files(o.results, {"timings.jsonl", "study.jsonl", "study.csv", "study.md", "study.html"},
                      {std::filesystem::path(o.results) / "confusion"}, inputs, o.data, plan.candidates);
    if (plan.candidates.empty())
        refuse(
            "--methods, --sizes, --recipes: expected something to study, found nothing that can be trained");
}

int study(const study_options& o) {
    const std::filesystem::path folder = o.results;
    const shard part = shard_of(o.shard);
    study_plan plan = plan_of(o);
    check(o, plan);
    const split_plan splits{rules_of(o.split), 0, o.splits};
    const candidate_list& candidates = plan.candidates;
    load_candidates(plan.candidates, o.data);
    catch_interrupts();
    const auto stopped = [] {
        tell("stopped; the same command goes on with what is left\n");
        return int{interrupted_by_user};
    };
    result_list results(folder / "evaluation.jsonl");
    merge(o, results);
    std::vector<task> all = tasks_of(candidates, splits);
    const std::string elsewhere = o.report_only ? take_from_elsewhere(all, results) : "";
    std::vector<task> to_do;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (!o.report_only && part.has(i, splits, candidates.size()) &&
            results.find(all[i].settings) == nullptr)
            to_do.push_back(all[i]);
    if (!o.report_only)
        tell("{} trainings to do, of {} in all ({})\n", to_do.size(), all.size(),
             printable((folder / "evaluation.jsonl").string()));
    std::vector<std::string> diverged;
    if (!train_all(to_do, o.jobs, results, &diverged))
        return stopped();
    for (const std::string& what : diverged)
        tell("{}\n", printable(what));
    const int status = diverged.empty() ? success : failed;
    if (part.count > 1) {
        tell("part {} of {} is done; study --merge takes over what all have found\n", part.index + 1,
             part.count);
        return status;
    }
    make_folder_of(folder / "timings.jsonl");
    timing_list timings(folder / "timings.jsonl");
    if (o.report_only) {
        timings.show_latest();
        tell_found(candidates, all, results, timings);
        if (!elsewhere.empty())
            tell("warning: {}, not by this program\n", printable(elsewhere));
        if (timings.others())
            tell("warning: times are by another program: {}\n", printable(text_of(timings.shown())));
    } else if (!time_all(candidates, timings, folder))
        return stopped();
    std::vector<study_row> rows =
        rows_of(candidates, splits, all, results, [&](const method& what, std::size_t bits) {
            const frame_latency* const found = timings.find(what, bits);
            return found != nullptr ? std::optional(*found) : std::nullopt;
        });
    std::ranges::move(plan.missing, std::back_inserter(rows));
    if (o.only_trained)
        std::erase_if(rows, [](const study_row& row) { return row.accuracies.empty(); });
    std::ranges::move(plan.not_built, std::back_inserter(rows));
    const image_data& data = *candidates.front().data;
    report(folder, rows,
           {fmt::format("{} images of {} classes in {}; {} {} splits{}", data.images.size(),
                        data.images.classes.size(), printable(o.data), o.splits,
                        o.split == "both" ? "random and as many blocked" : o.split,
                        elsewhere.empty() ? "" : "; " + printable(elsewhere)),
            text_of(timings.shown())});
    return status;
}

} // namespace

command add_study(CLI::App& program) {
    auto* app = program.add_subcommand(
        "study", "Train and time all methods at all sizes, and compare them with the paper on one page");
    auto o = std::make_shared<study_options>();
    add_data_option(*app, o->data);
    app->add_option(
        "--results", o->results,
        "Folder for results, which several programs can share; finished trainings are not repeated");
    std::set<std::string> names, sizes;
    for (const auto& m : all_methods()) {
        names.insert(m->name);
        sizes.insert(fmt::format("{}x{}", m->rows, m->columns));
    }
    app->add_option("--methods", o->methods, "Some of the methods (default: all)")
        ->delimiter(',')
        ->check(CLI::IsMember(names));
    app->add_option("--sizes", o->sizes, "Some of the sizes that were compiled in (default: all)")
        ->delimiter(',')
        ->check(CLI::IsMember(sizes));
    app->add_option("--recipes", o->recipes, "Some of 'default', 'thorough' and 'published'")
        ->delimiter(',')
        ->check(CLI::IsMember(recipe_names()));
    add_split_options(*app, o->split, o->splits, o->jobs);
    app->add_option("--pretrained", o->pretrained,
                    "ImageNet-pretrained networks, such as squeezenet=FILE, for the methods that need one")
        ->delimiter(',');
    add_bits_option(
        *app, o->bits,
        "8: networks in 8 bits too, where that form was compiled in; 32: in single precision alone");
    add_unknown_option(*app, o->unknown);
    app->add_option("--shard", o->shard,
                    "One part of all trainings, such as 2/8 on the second of eight machines");
    app->add_option("--merge", o->merged, "Folders of other parts, whose trainings are added")
        ->delimiter(',');
    app->add_flag(
           "--report-only", o->report_only,
           "Train and time nothing; report the results in the folder, also those of other versions and "
           "instruction sets")
        ->excludes("--shard"); // a part has no report
    app->add_flag("--only-trained", o->only_trained,
                  "Omit methods without a training from the report, but keep the paper's");
    return [o] { return study(*o); };
}
