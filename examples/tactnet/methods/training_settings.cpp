#include "methods/training_settings.hpp"

#include "number_options.hpp"
#include "usage_error.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

namespace {

tactnet::recipe published_recipe(const method& what) {
    if (!what.published)
        throw usage_error(fmt::format(
            "--recipe: expected default, since nothing was published for {}, found published", what.name));
    return tactnet::recipe::published(what.rows, what.columns, *what.published);
}

tactnet::recipe thorough_recipe(const method& what) {
    if (!may_be_thorough(what))
        throw usage_error(
            fmt::format("--recipe: expected default or published, since a thorough training is one of a "
                        "network that begins by chance, not of {}; found thorough",
                        what.name));
    return what.default_recipe().thorough();
}

} // namespace

const std::vector<std::string>& recipe_names() {
    static const std::vector<std::string> names{"default", "thorough", "published"};
    return names;
}

bool may_be_thorough(const method& what) {
    return what.is_network() && !what.pretrained();
}

void add_training_options(CLI::App& command, training_settings& s, const std::string& pretrained) {
    command.add_option("--rows", s.rows, "Rows of an image, tactels")
        ->type_name("N")
        ->check(whole_number(1, 4096))
        ->capture_default_str();
    command.add_option("--columns", s.columns, "Columns of an image, tactels")
        ->type_name("N")
        ->check(whole_number(1, 4096))
        ->capture_default_str();
    command.add_flag("--resize", s.resize,
                     "Resize images of another size (bicubic); without it they are an error");
    command
        .add_option(
            "--recipe", s.recipe,
            "How to train: 'default', 'thorough' (the same for longer), or as 'published' with the network")
        ->check(CLI::IsMember(recipe_names()))
        ->capture_default_str();
    command.add_option("--epochs", s.epochs, "Most epochs (default: the recipe's)")
        ->type_name("N")
        ->check(whole_number(1, 1'000'000));
    command.add_option("--batch", s.batch, "Images a step, 0 is all (default: the recipe's)")
        ->type_name("N")
        ->check(whole_number(0, 1'000'000));
    command.add_option("--rate", s.rate, "Highest learning rate, above 0 (default: the recipe's)")
        ->type_name("X")
        ->check(positive_number());
    command
        .add_option("--input", s.input,
                    "Counts minus their 'mean' image, 'scale'd by 1/255, or 'counts' as they are (default: "
                    "the recipe's)")
        ->check(CLI::IsMember({"mean", "scale", "counts"}));
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
        .add_option(pretrained, s.pretrained,
                    "For methods that begin with a network trained on photographs, such as squeezenet-svm: "
                    "its weights, a safetensors file with torchvision's names")
        ->type_name("FILE");
    command
        .add_option("--validation", s.shares.validation,
                    "Share of each class to choose the best epoch by, 0 to below 1")
        ->type_name("SHARE")
        ->check(share())
        ->capture_default_str();
    command.add_option("--test", s.shares.test, "Share of each class kept for the test, 0 to below 1")
        ->type_name("SHARE")
        ->check(share())
        ->capture_default_str();
}

void add_bits_option(CLI::App& command, std::size_t& bits, const std::string& what_for) {
    command.add_option("--bits", bits, what_for)
        ->type_name("N")
        ->check(CLI::IsMember({8, 32}))
        ->capture_default_str();
}

void check_bits(const method& what, std::size_t bits) {
    if (bits != 8 || what.has_eight_bit_form())
        return;
    if (!what.may_have_eight_bit_form())
        throw usage_error(fmt::format("--bits: expected a network that is trained from random weights, found "
                                      "the {} {}, which has no form in 8 bits",
                                      what.kind(), what.name));
    throw usage_error(fmt::format("--bits: expected a network whose form in 8 bits was compiled in, found {} "
                                  "{}x{}; those are chosen when building, by TACTNET_PROGRAM_EIGHT_BIT",
                                  what.name, what.rows, what.columns));
}

tactnet::split_rule split_rule_of(std::string_view name) {
    return name == "blocked" ? tactnet::split_rule::blocked : tactnet::split_rule::random;
}

std::string_view name_of(tactnet::split_rule rule) {
    return rule == tactnet::split_rule::blocked ? "blocked" : "random";
}

tactnet::recipe recipe_for(const method& what, const training_settings& s) {
    if (!is_share(s.shares.validation + s.shares.test))
        throw usage_error(
            fmt::format("--validation, --test: expected shares that leave some images for training, "
                        "found {} and {}",
                        s.shares.validation, s.shares.test));
    check_pretrained(what, s);
    check_bits(what, s.bits);
    if (!what.is_network() &&
        (s.epochs || s.batch || s.rate || s.input || s.augmentation || !s.start.empty()))
        throw usage_error(
            fmt::format("--epochs, --batch, --rate, --input, --augmentation, --start: expected a network, "
                        "found {}, which is not trained by epochs",
                        what.name));
    if (what.pretrained() && !s.start.empty())
        throw usage_error(
            fmt::format("--start: expected a network that begins with random weights, found {}, "
                        "which begins with those of --pretrained",
                        what.name));
    if (what.keeps_features() && s.augmentation && *s.augmentation != "none")
        throw usage_error(
            fmt::format("--augmentation: expected none, since features of images are found once, for {}; "
                        "found {}",
                        what.name, *s.augmentation));
    if (what.is_network() && what.keeps_features() && s.batch == 1U)
        throw usage_error(
            fmt::format("--batch: expected 0 or at least 2, since batch norms learn nothing from "
                        "one row of features, for {}; found 1",
                        what.name));
    if (what.pretrained() && s.input && *s.input != "scale")
        throw usage_error(
            fmt::format("--input: expected scale, as weights learnt from photographs want it, for {}; "
                        "found {}",
                        what.name, *s.input));
    tactnet::recipe r = s.recipe == "published"  ? published_recipe(what)
                        : s.recipe == "thorough" ? thorough_recipe(what)
                                                 : what.default_recipe();
    if (s.epochs)
        r.epochs = *s.epochs;
    if (s.batch)
        r.batch = *s.batch;
    if (s.rate)
        r.rate = *s.rate;
    else if (!s.start.empty() && s.recipe != "published")
        r.rate *= 0.3; // of 0.3 and 1 what did best from simulated images, with 4 and with 32 real ones
                       // a class
    if (s.input)
        r.input = *s.input == "mean"    ? tactnet::input_rule::subtract_mean
                  : *s.input == "scale" ? tactnet::input_rule::scale
                                        : tactnet::input_rule::counts;
    if (s.augmentation)
        r.augmentation = *s.augmentation == "none"         ? tactnet::augmentation_rule::none
                         : *s.augmentation == "each-epoch" ? tactnet::augmentation_rule::each_epoch
                                                           : tactnet::augmentation_rule::sixfold;
    return r;
}
