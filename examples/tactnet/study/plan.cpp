#include "study/plan.hpp"

#include "console.hpp"
#include "methods/registry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace {

bool chosen(const std::vector<std::string>& wanted, const std::string& name) {
    return wanted.empty() || std::ranges::find(wanted, name) != wanted.end();
}

} // namespace

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
