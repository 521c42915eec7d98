// tactnet study: the paper's experiments again, and what they cost in time, on one page.

#include "commands/commands.hpp"
#include "files/claims.hpp"
#include "methods/registry.hpp"
#include "reports/pictures.hpp"
#include "study/page.hpp"

#include <tactnet/io/write_file.hpp>

#include <interrupt.hpp>

namespace {

struct study_options : evaluation_options {
    std::vector<std::string> methods, sizes, recipes{"default", "published"}, pretrained;
    image_reading images{.resize = true};
    std::size_t bits = 8; ///< 8: networks in 8 bits too, where they have such a form
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
            std::ranges::none_of(photograph_networks, [&](const auto& n) { return n.name == name; }))
            refuse("--pretrained: expected a network and its file, such as "
                   "squeezenet=FILE, found '{}'",
                   text);
        files[name] = text.substr(middle + 1);
    }
    return files;
}

/// Every method at every size; those that need a file that was not given are left out. Throws usage_error.
candidate_list candidates_of(const study_options& o) {
    const auto files = pretrained_files(o);
    candidate_list list;
    for (const auto& m : all_methods()) {
        if (!chosen(o.methods, m->name) || !chosen(o.sizes, m->size()))
            continue;
        training_settings settings;
        settings.rows = m->rows, settings.columns = m->columns;
        settings.images = o.images;
        settings.bits = o.bits == 8 && m->has_eight_bit_form() ? 8 : 32;
        if (const auto needed = m->pretrained()) {
            const auto file = files.find(needed->network.name);
            if (file == files.end()) {
                tell("{} {} is left out: it needs {} trained on photographs, --pretrained {}=FILE\n", m->name,
                     m->size(), needed->network.title, needed->network.name);
                continue;
            }
            settings.pretrained = file->second;
        }
        std::set<std::string> tried; // recipes that come to the same
        for (const std::string& recipe : o.recipes) {
            if ((recipe == "published" && !(m->is_network() && m->published)) ||
                (recipe == "thorough" && !m->begins_at_random()))
                continue;
            settings.recipe = recipe;
            settings.epochs.reset();
            if (m->begins_at_random() && recipe != "published") { // one recipe for all, as in committed ones
                settings.augmentation = "each-epoch";
                settings.epochs = recipe_for(*m, settings).epochs;
            }
            if (tried.insert(std::string(recipe_for(*m, settings).name)).second)
                list.push_back({m.get(), settings});
        }
    }
    return list;
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
    tell_others(all, results);
    if (timings.others())
        tell("warning: times are by another program: {}\n", printable(text_of(timings.shown())));
}

/// False if interrupted.
bool time_all(const candidate_list& candidates, timing_list& timings, const std::filesystem::path& folder) {
    claims alone; // methods that are timed at once disturb each other
    if (!wait_until([&] { return alone.take(folder / "timings"); },
                    "waiting for another program that times methods for this folder"))
        return false;
    timings.read_on();
    stay_on_this_core();
    std::vector<timed_form> missing = forms_of(candidates);
    std::erase_if(missing,
                  [&](const timed_form& form) { return timings.find(*form.first, form.second) != nullptr; });
    progress line;
    std::size_t done = 0;
    for (const auto& [what, bits] : missing) {
        if (interrupted())
            return false;
        const frame_latency found = measure_latency(*what, bits);
        timings.add(*what, bits, found);
        ++done;
        line.show(fmt::format("{} of {} methods timed: {} {}{}, {:.1f} µs", done, missing.size(), what->name,
                              what->size(), bits == 8 ? " in 8 bits" : "", found.median),
                  done == missing.size());
    }
    return true;
}

void report(const std::filesystem::path& folder, const std::vector<study_row>& rows,
            const std::string& about) {
    write_rows(rows, folder, "study");
    const auto drawn = draw_study_pictures(rows, folder);
    tactnet::write_file(folder / "study.md", study_page(rows, drawn, about));
    if (const study_row* best = most_accurate(rows, shown_rule(rows)))
        plot_confusion(folder / "confusion", title_of(*best), best->confusion, best->classes);
    print(table(without_empty_columns(methods_table(rows).cells)));
    tell("the page: {}\n", printable((folder / "study.md").string()));
}

/// Throws usage_error.
void check(const study_options& o, const candidate_list& candidates) {
    std::vector<named_file> inputs;
    for (const auto& [name, file] : pretrained_files(o))
        inputs.push_back({"--pretrained", file});
    check_study_files(o.results, {"timings.jsonl", "study.jsonl", "study.csv", "study.md"},
                      {std::filesystem::path(o.results) / "confusion"}, inputs, o.data, candidates);
    if (candidates.empty())
        refuse(
            "--methods, --sizes, --recipes: expected something to study, found nothing that can be trained");
}

int study(const study_options& o) {
    const std::filesystem::path folder = o.results;
    candidate_list candidates = candidates_of(o);
    check(o, candidates);
    const split_plan splits = load_candidates(candidates, o);
    result_list results(folder / "evaluation.jsonl");
    std::vector<task> all = tasks_of(candidates, splits);
    std::vector<std::string> diverged;
    const std::string elsewhere =
        o.report_only || o.elsewhere ? take_from_elsewhere(all, results, o.report_only) : "";
    if (!o.report_only && !train_all(all, o.jobs, results, &diverged))
        return interrupted_by_user;
    for (const std::string& what : diverged)
        tell("{}\n", printable(what));
    make_folder_of(folder / "timings.jsonl");
    timing_list timings(folder / "timings.jsonl");
    if (o.report_only) {
        timings.show_latest();
        tell_found(candidates, all, results, timings);
    } else if (!time_all(candidates, timings, folder)) {
        tell("stopped; the same command goes on with what is left\n");
        return interrupted_by_user;
    }
    std::vector<study_row> rows =
        rows_of(candidates, splits, all, results, [&](const method& what, std::size_t bits) {
            const frame_latency* const found = timings.find(what, bits);
            return found != nullptr ? std::optional(*found) : std::nullopt;
        });
    if (o.only_trained)
        std::erase_if(rows, [](const study_row& row) { return row.confusion.classes() == 0; });
    const image_data& data = *candidates.front().data;
    report(folder, rows,
           fmt::format("{} images of {} classes in {}; {} {} splits{}. {}", data.images.size(),
                       data.images.classes.size(), printable(o.data), splits.splits,
                       splits.rules.size() > 1 ? "random and as many blocked" : name_of(splits.rules.front()),
                       elsewhere.empty() ? "" : "; " + printable(elsewhere), text_of(timings.shown())));
    return diverged.empty() ? success : failed;
}

} // namespace

command add_study(CLI::App& program) {
    auto* app = program.add_subcommand(
        "study", "Train and time all methods at all sizes, and compare them with the paper on one page");
    auto o = std::make_shared<study_options>();
    o->results = "study";
    o->usual_splits = 20;
    add_evaluation_options(*app, *o);
    add_sensor_option(*app, o->images.sensor);
    std::set<std::string> names, sizes;
    for (const auto& m : all_methods()) {
        names.insert(m->name);
        sizes.insert(m->size());
    }
    const auto add_list = [&](const char* option, std::vector<std::string>& to, const char* says) {
        return app->add_option(option, to, says)->delimiter(',');
    };
    add_list("--methods", o->methods, "Some of the methods (default: all)")->check(CLI::IsMember(names));
    add_list("--sizes", o->sizes, "Some of the sizes that were compiled in (default: all)")
        ->check(CLI::IsMember(sizes));
    add_list("--recipes", o->recipes, "Some of 'default', 'thorough' and 'published'")
        ->check(CLI::IsMember(recipe_names));
    add_list("--pretrained", o->pretrained,
             "ImageNet-pretrained networks, such as squeezenet=FILE, for the methods that need one");
    add_bits_option(
        *app, o->bits,
        "8: networks in 8 bits too, where that form was compiled in; 32: in single precision alone");
    app->add_flag(
        "--report-only", o->report_only,
        "Train and time nothing; report the results in the folder, also those of other versions and "
        "instruction sets");
    app->add_flag("--only-trained", o->only_trained, "Omit methods without a training from the report");
    return [o] { return study(*o); };
}
