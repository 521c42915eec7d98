#include "methods/description.hpp"

#include "data/input_file.hpp"

#include <tactnet/detail/instruction_set.hpp>
#include <tactnet/text/message.hpp>
#include <tactnet/version.hpp>

#include <fmt/format.h>

#include <map>
#include <mutex>
#include <type_traits>
#include <variant>

// Structured bindings take all fields of a struct or do not compile: a new one stops the compiler here, and a
// variant that gets another alternative does so too.

namespace {

template <class Plain>
concept plain = std::is_arithmetic_v<Plain> || std::is_convertible_v<Plain, std::string_view>;

std::string text(const plain auto& value) {
    return fmt::format("{}", value);
}

std::string text(const tactnet::sgd& rule) {
    const auto& [momentum, l2, l2_of_norms] = rule;
    return fmt::format("sgd momentum {} l2 {}{}", momentum, l2, l2_of_norms ? " of norms too" : "");
}
std::string text(const tactnet::adamw& rule) {
    const auto& [beta1, beta2, decay, epsilon] = rule;
    return fmt::format("adamw beta1 {} beta2 {} decay {} epsilon {}", beta1, beta2, decay, epsilon);
}

std::string text(const tactnet::constant_rate&) {
    static_assert(std::is_empty_v<tactnet::constant_rate>);
    return "constant";
}
std::string text(const tactnet::step_drop& rule) {
    const auto& [period, factor] = rule;
    return fmt::format("drop period {} factor {}", period, factor);
}
std::string text(const tactnet::one_cycle& rule) {
    const auto& [warm_up] = rule;
    return fmt::format("one cycle warm-up {}", warm_up);
}

std::string text(const tactnet::fixed_normal& rule) {
    const auto& [deviation] = rule;
    return fmt::format("normal deviation {}", deviation);
}
std::string text(const tactnet::he_normal&) {
    static_assert(std::is_empty_v<tactnet::he_normal>);
    return "he normal";
}

template <class... Rules>
std::string text(const std::variant<Rules...>& rule) {
    return std::visit([](const auto& chosen) { return text(chosen); }, rule);
}

std::string text(tactnet::input_rule rule) {
    return rule == tactnet::input_rule::subtract_mean ? "mean"
           : rule == tactnet::input_rule::scale       ? "scale"
                                                      : "counts";
}
std::string text(tactnet::augmentation_rule rule) {
    return rule == tactnet::augmentation_rule::none         ? "none"
           : rule == tactnet::augmentation_rule::each_epoch ? "each-epoch"
                                                            : "sixfold";
}

std::string text(const tactnet::augmentation_ranges& ranges) {
    const auto& [reflect_rows, reflect_columns, translation, rotation, scale, pressure, shear, erase, noise] =
        ranges;
    std::string all =
        fmt::format("reflect rows {} columns {} translation {} rotation {} scale {} pressure {}",
                    reflect_rows, reflect_columns, translation, rotation, scale, pressure);
    if (shear != 0)
        all += fmt::format(" shear {}", shear);
    if (erase != 0)
        all += fmt::format(" erase {}", erase);
    if (noise != tactnet::pressure_noise{})
        all += fmt::format(" noise {} of a count {}", noise.additive, noise.relative);
    return all;
}

} // namespace

std::string fingerprint_of(const tactnet::file_metadata& settings) {
    fingerprint print;
    for (const auto& [key, value] : settings) {
        print.add(key);
        print.add(value);
    }
    return print.text();
}

std::string pretrained_fingerprint(const std::string& path) {
    static std::mutex mutex;
    static std::map<std::string, std::string> known;
    const std::lock_guard lock(mutex);
    std::string& print = known[path];
    if (print.empty())
        print = file_fingerprint(path);
    return print;
}

tactnet::file_metadata describe_recipe(const tactnet::recipe& recipe) {
    const auto& [name, epochs, batch, rate, pretrained_rate, optimiser, schedule, initialisation, input,
                 function, augmentation, ranges, reflections, augment_full_resolution, label_smoothing,
                 sharpness_radius, averaging, epsilon, remeasure_statistics, validate_every, patience,
                 keeps_last] = recipe;
    tactnet::file_metadata all{
        {"recipe", text(name)},
        {"epochs", text(epochs)},
        {"batch", text(batch)},
        {"rate", text(rate)},
        {"optimiser", text(optimiser)},
        {"schedule", text(schedule)},
        {"initialisation", text(initialisation)},
        {"input", text(input)},
        {"augmentation", text(augmentation)},
        {"augmentation_ranges", text(ranges)},
        {"label_smoothing", text(label_smoothing)},
        {"averaging", text(averaging)},
        {"epsilon", text(epsilon)},
        {"remeasure_statistics", text(remeasure_statistics)},
        {"validate_every", text(validate_every)},
        {"patience", text(patience)},
    };
    static_cast<void>(augment_full_resolution); // of images that were taken larger: see describe_training
    // Left out where they are the default, so that the committed results of the study are found.
    if (pretrained_rate != 1)
        all["pretrained_rate"] = text(pretrained_rate);
    if (sharpness_radius != 0)
        all["sharpness_radius"] = text(sharpness_radius);
    if (keeps_last)
        all["keeps"] = "last";
    if (!function.identity())
        all["function"] = fmt::format(
            "{} knee {}", tactnet::count_rule_names[static_cast<std::size_t>(function.rule)], function.knee);
    for (const auto& [axis, rule] :
         {std::pair("rows", &reflections.rows), std::pair("columns", &reflections.columns)})
        for (std::size_t c = 0; c < rule->partners.size(); ++c)
            if (rule->partners[c] != c)
                all[fmt::format("partner_{}_{}", axis, c)] = fmt::to_string(rule->partners[c]);
    return all;
}

void require_metadata(const tactnet::safetensors& file, const tactnet::file_metadata& expected) {
    for (const auto& [key, value] : expected) {
        const auto found = file.metadata().find(key);
        if (found == file.metadata().end() || found->second != value)
            throw tactnet::file_error(
                file.file(), fmt::format("metadata '{}'", key), tactnet::in_quotes(value),
                found == file.metadata().end() ? "none" : tactnet::in_quotes(found->second));
    }
}

tactnet::file_metadata describe_program() {
    return {
        {"library",
         fmt::format("{}.{}.{}", TACTNET_VERSION_MAJOR, TACTNET_VERSION_MINOR, TACTNET_VERSION_PATCH)},
        {"instruction_set", std::string(tactnet::instruction_set)},
    };
}

std::string float_instruction_set(std::string name) {
    // Of integers and bytes alone, whose results are exact.
    for (const std::string_view part :
         {"_bmi2", "_lzcnt", "_cd", "_vbmi", "_vnni", "_avxvnni", "_dotprod", "_i8mm", "_dsp"})
        for (std::size_t at = 0; (at = name.find(part, at)) != std::string::npos;)
            if (const std::size_t end = at + part.size(); end == name.size() || name[end] == '_')
                name.erase(at, part.size());
            else
                at = end;
    return name;
}

tactnet::file_metadata describe_method(const method& what, const tactnet::recipe& recipe) {
    tactnet::file_metadata all = what.parts();
    if (what.is_network())
        all.merge(describe_recipe(recipe)); // what the parts say of the input goes before
    return all;
}

tactnet::file_metadata describe_training(const method& what, const training_settings& s,
                                         tactnet::split_rule rule, std::uint64_t seed,
                                         const image_data& data) {
    tactnet::file_metadata all{
        {"network", what.name}, // of every method
        {"rows", fmt::to_string(what.rows)},
        {"columns", fmt::to_string(what.columns)},
        {"data", data.fingerprint},
        {"split", std::string(name_of(rule))},
        {"seed", fmt::to_string(seed)},
        {"validation_share", fmt::to_string(s.shares.validation)},
        {"test_share", fmt::to_string(s.shares.test)},
    };
    all.merge(describe_program());
    all["instruction_set"] = float_instruction_set(all["instruction_set"]);
    // Left out where they are not used, so that earlier results are found.
    if (tactnet::needs_groups(rule))
        all["groups"] = data.groups_fingerprint;
    if (rule == tactnet::split_rule::given)
        all["given"] = data.given_fingerprint;
    else if (tactnet::has_folds(rule) && rule != tactnet::split_rule::leave_one_group_out)
        all["folds"] = fmt::to_string(s.folds);
    if (s.balance)
        all["balance"] = "true";
    if (s.share < 1)
        all["training_share"] = fmt::to_string(s.share);
    if (s.bits == 8)
        all["bits"] = "8";
    if (!s.start.empty())
        all["start"] = file_fingerprint(s.start);
    if (!s.pretrained.empty())
        all["pretrained"] = pretrained_fingerprint(s.pretrained);
    const auto training = split_for(data, s, rule, seed).training;
    tactnet::recipe recipe = recipe_for(what, s, training.size());
    // What mean images alone choose is described as if options said it: they are cheap to ask, and where they
    // choose what the recipe has, results are found that were made before they were asked. Trials are not.
    if (tactnet::thread_pool alone; s.chooses(what) && !s.tries(what))
        recipe = choose_recipe(what, s, data, training, seed, alone, {}).chosen;
    if (recipe.augment_full_resolution && recipe.augmentation != tactnet::augmentation_rule::none &&
        what.augment_full_resolution(data.taken.size))
        all["varied"] =
            fmt::format("{}x{} {}", data.taken.size.rows, data.taken.size.columns, data.taken.fingerprint);
    all.merge(describe_method(what, recipe));
    if (s.tries(what))
        all["augmentation"] = "auto"; // of what it chooses among, the ranges
    for (const std::string& partners : s.partners)
        all["partners"] += partners + ' ';
    return all;
}

tactnet::file_metadata describe_trials(const method& what, const training_settings& s,
                                       const image_data& data) {
    if (!s.tries(what))
        return {};
    const auto [rows, columns, movement, function] = fixed_kinds(s);
    return {{"trials_of", fmt::format("fixed rows {} columns {} movement {} function {}, groups {}", rows,
                                      columns, movement, function, data.groups_fingerprint)}};
}
