#include "settings.hpp"

#include "data.hpp"
#include "machines.hpp"
#include "usage_error.hpp"

#include <tactnet/version.hpp>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <type_traits>
#include <variant>

namespace {

tactnet::recipe published_recipe(std::string_view network, std::size_t rows, std::size_t columns) {
    if (network == "tactnet4")
        return tactnet::recipe::published(rows, columns, 0.05, 200, 3);
    if (network.starts_with("tactnet6"))
        return tactnet::recipe::published(rows, columns, 0.01, 150, 4);
    if (network == "tactresnet")
        return tactnet::recipe::published(rows, columns, 0.002, 0, 5);
    throw usage_error(fmt::format(
        "--recipe: expected default, since nothing was published for {}, found published", network));
}

std::string text_of(const tactnet::optimiser& rule) {
    if (const auto* sgd = std::get_if<tactnet::sgd>(&rule))
        return fmt::format("sgd momentum {} l2 {}", sgd->momentum, sgd->l2);
    const auto& adamw = std::get<tactnet::adamw>(rule);
    return fmt::format("adamw beta1 {} beta2 {} decay {} epsilon {}", adamw.beta1, adamw.beta2, adamw.decay,
                       adamw.epsilon);
}

std::string text_of(const tactnet::schedule& rule) {
    if (const auto* drop = std::get_if<tactnet::step_drop>(&rule))
        return fmt::format("drop period {} factor {}", drop->period, drop->factor);
    if (const auto* cycle = std::get_if<tactnet::one_cycle>(&rule))
        return fmt::format("one cycle warm-up {}", cycle->warm_up);
    return "constant";
}

std::string text_of(const tactnet::initialisation& rule) {
    if (const auto* fixed = std::get_if<tactnet::fixed_normal>(&rule))
        return fmt::format("normal deviation {}", fixed->deviation);
    return "he normal";
}

std::string_view text_of(tactnet::augmentation_rule rule) {
    switch (rule) {
    case tactnet::augmentation_rule::none:
        return "none";
    case tactnet::augmentation_rule::each_epoch:
        return "each-epoch";
    case tactnet::augmentation_rule::sixfold:
        break;
    }
    return "sixfold";
}

std::string text_of(const tactnet::augmentation_ranges& r) {
    return fmt::format("reflect rows {} columns {} translation {} rotation {} scale {} pressure {}",
                       r.reflect_rows, r.reflect_columns, r.translation, r.rotation, r.scale, r.pressure);
}

// The names of inline namespaces tell instruction sets apart: on another one the same training rounds
// differently.
#define TACTNET_PROGRAM_TEXT_OF(x) #x
#define TACTNET_PROGRAM_TEXT(x) TACTNET_PROGRAM_TEXT_OF(x)
constexpr std::string_view instruction_set = TACTNET_PROGRAM_TEXT(TACTNET_ARCH);

} // namespace

void add_training_options(CLI::App& command, training_settings& s) {
    command.add_option("--rows", s.rows, "Rows of the network's input, tactels")
        ->type_name("N")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    command.add_option("--columns", s.columns, "Columns of the network's input, tactels")
        ->type_name("N")
        ->check(CLI::Range(1, 4096))
        ->capture_default_str();
    command.add_flag("--resize", s.resize,
                     "Resize images of another size (bicubic); without it they are an error");
    command.add_option("--recipe", s.recipe, "How to train: 'default', or as 'published' with the network")
        ->check(CLI::IsMember({"default", "published"}))
        ->capture_default_str();
    command.add_option("--epochs", s.epochs, "Most epochs (default: the recipe's)")
        ->type_name("N")
        ->check(CLI::Range(1, 1'000'000));
    command.add_option("--batch", s.batch, "Images a step, 0 is all (default: the recipe's)")
        ->type_name("N")
        ->check(CLI::Range(0, 1'000'000));
    command.add_option("--rate", s.rate, "Highest learning rate, above 0 (default: the recipe's)")
        ->type_name("X")
        ->check(CLI::PositiveNumber);
    command
        .add_option("--input", s.input,
                    "Counts minus their 'mean' image, or 'scale'd by 1/255 (default: the recipe's)")
        ->check(CLI::IsMember({"mean", "scale"}));
    command
        .add_option("--augmentation", s.augmentation,
                    "New images: 'none', drawn anew 'each-epoch', or five for each image once: 'sixfold' "
                    "(default: the recipe's)")
        ->check(CLI::IsMember({"none", "each-epoch", "sixfold"}));
    command
        .add_option(
            "--start", s.start,
            "Begin with the network of this weight file, such as one trained on simulated images, in place "
            "of random weights; the default recipe then takes 0.3 of its rate")
        ->type_name("FILE");
    command
        .add_option("--validation", s.shares.validation,
                    "Share of each class to choose the best epoch by, 0 to below 1")
        ->type_name("SHARE")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
    command.add_option("--test", s.shares.test, "Share of each class kept for the test, 0 to below 1")
        ->type_name("SHARE")
        ->check(CLI::Range(0.0, 1.0))
        ->capture_default_str();
}

tactnet::split_rule split_rule_of(std::string_view name) {
    return name == "blocked" ? tactnet::split_rule::blocked : tactnet::split_rule::random;
}

std::string_view name_of(tactnet::split_rule rule) {
    return rule == tactnet::split_rule::blocked ? "blocked" : "random";
}

tactnet::recipe recipe_for(std::string_view network, const training_settings& s) {
    if (s.shares.validation + s.shares.test >= 1)
        throw usage_error(
            fmt::format("--validation, --test: expected shares that leave some images for training, "
                        "found {} and {}",
                        s.shares.validation, s.shares.test));
    if (is_machine(network) &&
        (s.epochs || s.batch || s.rate || s.input || s.augmentation || !s.start.empty()))
        throw usage_error(
            fmt::format("--epochs, --batch, --rate, --input, --augmentation, --start: expected a network, "
                        "found {}, which is not trained by epochs",
                        network));
    tactnet::recipe r = s.recipe == "published" ? published_recipe(network, s.rows, s.columns)
                                                : tactnet::recipe::standard(s.rows, s.columns);
    if (s.epochs)
        r.epochs = *s.epochs;
    if (s.batch)
        r.batch = *s.batch;
    if (s.rate)
        r.rate = *s.rate;
    else if (!s.start.empty() && s.recipe == "default")
        r.rate *= 0.3; // of 0.3 and 1 what did best from simulated images, with 4 and with 32 real ones
                       // a class
    if (s.input)
        r.input = *s.input == "mean" ? tactnet::input_rule::subtract_mean : tactnet::input_rule::scale;
    if (s.augmentation)
        r.augmentation = *s.augmentation == "none"         ? tactnet::augmentation_rule::none
                         : *s.augmentation == "each-epoch" ? tactnet::augmentation_rule::each_epoch
                                                           : tactnet::augmentation_rule::sixfold;
    return r;
}

tactnet::file_metadata describe_recipe(const tactnet::recipe& r) {
    return {
        {"recipe", std::string(r.name)},
        {"epochs", fmt::to_string(r.epochs)},
        {"batch", fmt::to_string(r.batch)},
        {"rate", fmt::to_string(r.rate)},
        {"optimiser", text_of(r.optimiser)},
        {"schedule", text_of(r.schedule)},
        {"initialisation", text_of(r.initialisation)},
        {"input", r.input == tactnet::input_rule::scale ? "scale" : "mean"},
        {"augmentation", std::string(text_of(r.augmentation))},
        {"augmentation_ranges", text_of(r.ranges)},
        {"label_smoothing", fmt::to_string(r.label_smoothing)},
        {"remeasure_statistics", fmt::to_string(r.remeasure_statistics)},
        {"averaging", fmt::to_string(r.averaging)},
        {"epsilon", fmt::to_string(r.epsilon)},
        {"validate_every", fmt::to_string(r.validate_every)},
        {"patience", fmt::to_string(r.patience)},
    };
}

tactnet::file_metadata describe_training(const method& what, const training_settings& s,
                                         tactnet::split_rule rule, std::uint64_t seed,
                                         std::string_view data) {
    tactnet::file_metadata all{
        {"network", what.name},
        {"rows", fmt::to_string(what.rows)},
        {"columns", fmt::to_string(what.columns)},
        {"data", std::string(data)},
        {"split", std::string(name_of(rule))},
        {"seed", fmt::to_string(seed)},
        {"validation_share", fmt::to_string(s.shares.validation)},
        {"test_share", fmt::to_string(s.shares.test)},
        {"library",
         fmt::format("{}.{}.{}", TACTNET_VERSION_MAJOR, TACTNET_VERSION_MINOR, TACTNET_VERSION_PATCH)},
        {"instruction_set", std::string(instruction_set)},
    };
    if (!s.start.empty())
        all["start"] = file_fingerprint(s.start);
    all.merge(what.describe(recipe_for(what.name, s)));
    return all;
}
