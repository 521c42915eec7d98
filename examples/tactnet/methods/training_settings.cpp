#include "methods/training_settings.hpp"

#include "console.hpp"
#include "data/image_data.hpp"
#include "number_options.hpp"

#include <tactnet/text/message.hpp>

#include <nlohmann/json.hpp>

#include <numeric>

namespace {

/// Throws usage_error when the settings name a file for a method that has no use for it, and when they name
/// none for one that needs it: then with what it must be and how to make it.
void check_pretrained(const method& what, const training_settings& settings) {
    const auto file = what.pretrained();
    if (!file && !settings.pretrained.empty())
        refuse("--pretrained: expected a method that begins with a network trained on photographs, found {}, "
               "which learns all by itself",
               what.name);
    if (file && settings.pretrained.empty())
        refuse(
            "--pretrained: {0} expects a file of {1}'s weights, found none. It is a safetensors file with "
            "torchvision's names ({2}, ...) in float32, float16 or bfloat16, at least {3:.1f} MB in float32, "
            "trained on photographs of {4} x {5} with torchvision's normalisation, or with an array "
            "'input_mean' of three numbers that are subtracted from counts of 0 to 255. Python makes it "
            "where "
            "torchvision and safetensors are: import torchvision; from safetensors.torch import save_file; "
            "save_file(torchvision.models.{6}(weights=\"IMAGENET1K_V1\").state_dict(), "
            "\"{6}.safetensors\"); see docs/train/transfer.md",
            what.name, file->network.title, file->array, static_cast<double>(file->bytes) * 1e-6,
            file->network.photograph.rows, file->network.photograph.columns, file->network.torchvision);
}

/// Throws usage_error for settings that do not go with a method.
void check_settings(const method& what, const training_settings& s) {
    if (!is_share(s.shares.validation + s.shares.test))
        refuse("--validation, --test: expected shares that leave some images for training, found {} and {}",
               s.shares.validation, s.shares.test);
    check_pretrained(what, s);
    check_bits(what, s.bits);
    if (!what.is_network() && static_cast<const epoch_settings&>(s) != epoch_settings{})
        refuse(
            "--reflect, --partners, --scale, --gain, --noise, --erase, --input-function, --knee, --epochs, "
            "--batch, --rate, --input, --augmentation, --rotation, --translation, --start: expected a "
            "network, found {}, which is not trained by epochs",
            what.name);
    if (what.pretrained() && !s.start.empty())
        refuse("--start: expected a network that begins with random weights, found {}, which begins with "
               "those of --pretrained",
               what.name);
    if (s.augmentation == "none" && (s.rotation || s.translation || s.scale || s.gain || s.noise || s.erase ||
                                     s.reflect || !s.partners.empty()))
        refuse(
            "--scale, --gain, --noise, --erase, --reflect, --partners, --rotation, --translation: expected "
            "an augmentation, which they change, found --augmentation none");
    if (!s.partners.empty() && (s.reflect == "none" || s.reflect == "rows"))
        refuse("--partners: expected reflections of columns, which exchange them, found --reflect {}",
               *s.reflect);
    if (s.augmentation == "auto" && !s.chooses(what))
        refuse("--augmentation: expected none, each-epoch or sixfold for {}, found auto",
               what.begins_at_random() ? "the published recipe"
                                       : what.name + ", which does not begin with random weights");
    if (s.knee && !(s.function && s.function->ends_with("log")))
        refuse("--knee: expected --input-function log or relative-log, whose knee it is, found none");
    if (what.pretrained() && s.input && *s.input != "scale")
        refuse("--input: expected scale, as weights learnt from photographs want it, for {}; found {}",
               what.name, *s.input);
    if (s.recipe == "published" && !what.published)
        refuse("--recipe: expected default, since nothing was published for {}, found published", what.name);
    if (s.recipe == "thorough" && !what.begins_at_random())
        refuse("--recipe: expected default or published, since a thorough training is one of a network that "
               "begins by chance, not of {}; found thorough",
               what.name);
}

} // namespace

void add_data_option(CLI::App& command, std::string& folder) {
    command
        .add_option("--data", folder,
                    "Folder with one subfolder per class, each with grey JPEG, PNG or NPY images")
        ->type_name("FOLDER")
        ->required();
}

void add_sensor_option(CLI::App& command, std::string& sensor) {
    command
        .add_option(
            "--sensor", sensor,
            "Description of the array (JSON), whose full_scale becomes 255 of images with more than 8 "
            "bits; otherwise they are an error")
        ->type_name("FILE");
}

void add_image_options(CLI::App& command, image_reading& images) {
    command.add_flag("--resize", images.resize,
                     "Resize images of another size (bicubic); otherwise they are an error");
    add_sensor_option(command, images.sensor);
}

void add_training_options(CLI::App& command, training_settings& s, const std::string& pretrained) {
    add_option(command, "--rows", s.rows, whole_number(1, 4096), "Rows of an image");
    add_option(command, "--columns", s.columns, whole_number(1, 4096), "Columns of an image");
    add_image_options(command, s.images);
    add_option(command, "--recipe", s.recipe, CLI::IsMember(recipe_names),
               "Training recipe: 'default', 'thorough' (the same for longer), or 'published' (the paper's)");
    add_option(command, "--epochs", s.epochs, whole_number(1, 1'000'000),
               "Maximum number of epochs (default: the recipe's)");
    add_option(command, "--batch", s.batch, whole_number(0, 1'000'000),
               "Images per step, 0 for all (default: the recipe's)");
    add_option(command, "--rate", s.rate, positive_number(), "Highest learning rate (default: the recipe's)");
    add_option(command, "--input", s.input, CLI::IsMember({"mean", "scale", "counts"}),
               "Subtract the 'mean' image, 'scale' counts by 1/255, or use 'counts' unchanged (default: the "
               "recipe's)");
    add_option(
        command, "--augmentation", s.augmentation, CLI::IsMember({"auto", "none", "each-epoch", "sixfold"}),
        "Augmentation: 'none', new images in 'each-epoch', five more per image, drawn once: 'sixfold', "
        "or 'auto': as 'each-epoch', with the kinds that mean images and short trainings on held-out images "
        "choose (default: auto for the default recipe, without these trainings for thorough)");
    add_option(command, "--reflect", s.reflect, CLI::IsMember({"none", "rows", "columns", "both"}),
               "Reflect images upside down, 'rows', left to right, 'columns', or 'both' (default: what "
               "--augmentation says)");
    command
        .add_option("--partners", s.partners,
                    "Classes that reflections of columns exchange, as left_side=right_side; all others "
                    "stay what they are")
        ->type_name("CLASS=CLASS");
    add_option(command, "--scale", s.scale, number_up_to(10),
               "Share by which augmentation enlarges or reduces images at most");
    add_option(command, "--gain", s.gain, number_up_to(10),
               "Share by which augmentation changes all counts of an image at most");
    add_option(command, "--noise", s.noise, number_up_to(10), "Noise of augmentation, a share of each count");
    add_option(command, "--erase", s.erase, number_up_to(1), "Share of images of which a part is erased");
    add_option(command, "--input-function", s.function, CLI::IsMember(tactnet::count_rule_names),
               "How counts are compressed: 'identity', square 'root', 'log', or 'relative-log' of counts "
               "divided by the mean of the image (default: what --augmentation says)");
    add_option(command, "--knee", s.knee, positive_number(),
               "Counts, or multiples of the mean, from which 'log' compresses (default: 8, or 1)");
    add_option(command, "--rotation", s.rotation, number_up_to(180),
               "Degrees by which augmentation turns images at most (default: the recipe's)");
    add_option(command, "--translation", s.translation, number_up_to(4096),
               "Tactels by which augmentation moves images at most, along both axes (default: the recipe's)");
    command.add_option(
        "--start", s.start,
        "Start from the network of this weight file, for example one trained on simulated "
        "images, instead of from random weights; the default recipe then uses 0.3 of its learning rate");
    command.add_option(pretrained, s.pretrained,
                       "Weights of an ImageNet-pretrained network, for methods such as squeezenet-svm: a "
                       "safetensors file with torchvision's names");
    add_option(command, "--validation", s.shares.validation, share(),
               "Share of each class for validation, which selects the best epoch");
    add_option(command, "--test", s.shares.test, share(), "Share of each class for the test");
    add_option(command, "--folds", s.folds, whole_number(2, 10'000),
               "Number of folds, for --split group-folds and stratified-folds");
    command.add_flag("--balance", s.balance,
                     "Repeat training images of rare classes until all classes have as many");
}

void add_bits_option(CLI::App& command, std::size_t& bits, const std::string& what_for) {
    add_option(command, "--bits", bits, CLI::IsMember({8, 32}), what_for);
}

void check_bits(const method& what, std::size_t bits) {
    if (bits != 8 || what.has_eight_bit_form())
        return;
    if (!what.begins_at_random())
        refuse(
            "--bits: expected a network that is trained from random weights, found the {} {}, which has no "
            "form in 8 bits",
            what.kind(), what.name);
    refuse("--bits: expected a network whose form in 8 bits was compiled in, found {} {}; those are chosen "
           "when building, by TACTNET_PROGRAM_EIGHT_BIT",
           what.name, what.size());
}

std::string_view name_of(tactnet::split_rule rule) {
    return std::ranges::find(split_rule_names, rule,
                             &std::pair<std::string_view, tactnet::split_rule>::second)
        ->first;
}

tactnet::split_rule split_rule_for(std::string_view name, const image_data& data, tactnet::split_rule usual) {
    if (name.empty())
        return data.given             ? tactnet::split_rule::given
               : !data.groups.empty() ? tactnet::split_rule::grouped
                                      : usual;
    const auto found =
        std::ranges::find(split_rule_names, name, &std::pair<std::string_view, tactnet::split_rule>::first);
    if (found == split_rule_names.end())
        refuse("expected a split such as random or grouped, found {}", tactnet::in_quotes(name));
    if (tactnet::needs_groups(found->second) && data.groups.empty())
        refuse("--split {}: expected groups of images, by --group, --group-folders or --table, found none",
               name);
    if (found->second == tactnet::split_rule::given && !data.given)
        refuse("--split given: expected a --table with a column 'split', found none");
    return found->second;
}

void add_split_option(CLI::App& command, std::string& name, std::string_view usual, std::string_view more) {
    std::vector<std::string> names;
    for (const auto& [known, rule] : split_rule_names)
        names.emplace_back(known);
    if (!more.empty())
        names.emplace_back(more);
    command
        .add_option(
            "--split", name,
            fmt::format("'random'; 'blocked': neighbours in the order of recording stay together; "
                        "'grouped', 'group-folds', 'leave-one-group-out': groups stay together; "
                        "'stratified-folds'; 'given': of a table (default: of a table, or grouped where "
                        "there are groups, or else {})",
                        usual))
        ->check(CLI::IsMember(names));
}

std::optional<std::size_t> splits_of(tactnet::split_rule rule, const image_data& data, std::size_t folds) {
    if (rule == tactnet::split_rule::given)
        return 1;
    if (!tactnet::has_folds(rule))
        return std::nullopt;
    return rule == tactnet::split_rule::leave_one_group_out ? data.group_names.size() : folds;
}

tactnet::data_split split_for(const image_data& data, const training_settings& s, tactnet::split_rule rule,
                              std::uint64_t seed) {
    tactnet::data_split split;
    try {
        split = rule == tactnet::split_rule::given
                    ? *data.given
                    : tactnet::split_data(data.images.labels, data.images.classes.size(), data.groups, rule,
                                          seed, s.shares, s.folds);
    } catch (const std::invalid_argument& error) { // too few for the folds
        refuse("--split {}: {}", name_of(rule), error.what());
    }
    if (split.training.empty())
        refuse("--split {}: expected images to train, found none", name_of(rule));
    const bool by_groups = tactnet::needs_groups(rule) || rule == tactnet::split_rule::given;
    const auto groups = by_groups ? std::span(data.groups) : std::span<const std::size_t>();
    if (s.share < 1)
        split = tactnet::part_of_training(std::move(split), data.images.labels, groups, s.share, seed);
    if (const auto problem = tactnet::problem_of(split, data.images.labels, groups)) {
        const auto& [kind, image, part, other] = *problem;
        const std::string name = data.name(image);
        if (kind == tactnet::split_problem::lacking_class)
            refuse(
                "--split {}, seed {}: expected training images of the class {}, of which {} is for {}, found "
                "none",
                name_of(rule), seed, tactnet::in_quotes(data.images.classes[data.images.labels[image]]), name,
                tactnet::split_parts[part]);
        refuse("--split {}: expected each {} in one part, found {} for {} and for {}", name_of(rule),
               kind == tactnet::split_problem::overlap ? "image" : "group",
               kind == tactnet::split_problem::overlap
                   ? name
                   : fmt::format("{} ({})", tactnet::in_quotes(data.group_names[data.groups[image]]), name),
               tactnet::split_parts[other], tactnet::split_parts[part]);
    }
    return s.balance ? tactnet::balanced(std::move(split), data.images.labels) : split;
}

namespace {

/// What options say of augmentation and input function. Images choose the rest: see choose_recipe.
void apply_kinds(tactnet::recipe& r, const training_settings& s) {
    const auto set = [](double& to, const std::optional<double>& value) { to = value.value_or(to); };
    set(r.ranges.rotation, s.rotation), set(r.ranges.translation, s.translation);
    set(r.ranges.scale, s.scale), set(r.ranges.pressure, s.gain), set(r.ranges.erase, s.erase);
    set(r.ranges.noise.relative, s.noise);
    if (s.reflect) {
        r.reflections.rows.reflects = *s.reflect == "rows" || *s.reflect == "both";
        r.reflections.columns.reflects = *s.reflect == "columns" || *s.reflect == "both";
        r.ranges.reflect_rows = r.reflections.rows.reflects ? 0.5 : 0;
        r.ranges.reflect_columns = r.reflections.columns.reflects ? 0.5 : 0;
    }
    if (s.function) {
        const auto rule = std::ranges::find(tactnet::count_rule_names, *s.function);
        r.function = {static_cast<tactnet::count_rule>(rule - tactnet::count_rule_names.begin()),
                      static_cast<float>(s.knee.value_or(*s.function == "log" ? 8 : 1))};
    }
}

/// Throws usage_error for what is no pair of classes.
std::vector<std::size_t> partners_of(std::span<const std::string> pairs,
                                     const std::vector<std::string>& classes) {
    std::vector<std::size_t> partners(classes.size());
    std::iota(partners.begin(), partners.end(), std::size_t{0});
    for (const std::string& pair : pairs) {
        const std::size_t middle = pair.find('=');
        const auto index = [&](const std::string& name) {
            return static_cast<std::size_t>(std::ranges::find(classes, name) - classes.begin());
        };
        const std::size_t a = index(pair.substr(0, middle)),
                          b = middle == std::string::npos ? classes.size() : index(pair.substr(middle + 1));
        if (a >= classes.size() || b >= classes.size() || partners[a] != a || partners[b] != b)
            refuse("--partners: expected two classes as left=right, each named once, found {}", pair);
        partners[a] = b, partners[b] = a;
    }
    return partners;
}

} // namespace

tactnet::augmentation_choice choose_recipe(const method& what, const training_settings& s,
                                           const image_data& data, std::span<const std::size_t> training,
                                           std::uint64_t seed, tactnet::thread_pool& threads,
                                           const tactnet::search_stop& stop, tactnet::trial_scores* known) {
    tactnet::recipe recipe = recipe_for(what, s, training.size());
    if (!s.partners.empty()) {
        recipe.ranges.reflect_columns = 0.5;
        recipe.reflections.columns = {true, partners_of(s.partners, data.images.classes)};
    }
    if (!s.chooses(what))
        return {recipe, {}, {}};
    return what.choose(recipe, data, training, seed, threads, s.tries(what), fixed_kinds(s), stop, known);
}

tactnet::fixed_augmentation fixed_kinds(const training_settings& s) {
    return {.rows = s.reflect.has_value(),
            .columns = s.reflect || !s.partners.empty(),
            .movement = s.rotation || s.translation || s.scale,
            .function = s.function.has_value()};
}

tactnet::file_metadata with_trials(tactnet::file_metadata settings, const tactnet::trial_scores& scores) {
    if (!scores.empty())
        settings["trials"] = nlohmann::json(scores).dump();
    return settings;
}

tactnet::trial_scores trials_in(const tactnet::safetensors_index& checkpoint) {
    const std::string* const text = checkpoint.find_metadata("setting.trials");
    try {
        return text == nullptr ? tactnet::trial_scores()
                               : nlohmann::json::parse(*text).get<tactnet::trial_scores>();
    } catch (const nlohmann::json::exception& error) {
        throw tactnet::file_error(checkpoint.file(), "metadata 'setting.trials'", "lists of numbers",
                                  error.what());
    }
}

tactnet::recipe recipe_for(const method& what, const training_settings& s, std::size_t training_images) {
    check_settings(what, s);
    tactnet::recipe r = s.recipe == "published"
                            ? tactnet::recipe::published(what.rows, what.columns, *what.published)
                        : s.recipe == "thorough" ? what.default_recipe().thorough()
                                                 : what.default_recipe();
    if (s.epochs)
        r.epochs = *s.epochs;
    else if (training_images > 0 && s.recipe != "published" && what.begins_at_random())
        r = r.suited_to(training_images);
    if (s.batch)
        r.batch = *s.batch;
    if (s.rate)
        r.rate = *s.rate;
    else if (!s.start.empty() && s.recipe != "published")
        r.rate *= 0.3; // did better than 1 from simulated images, with 4 and with 32 real ones a class
    if (s.input)
        r.input = *s.input == "mean"    ? tactnet::input_rule::subtract_mean
                  : *s.input == "scale" ? tactnet::input_rule::scale
                                        : tactnet::input_rule::counts;
    if (s.augmentation)
        r.augmentation = *s.augmentation == "none"      ? tactnet::augmentation_rule::none
                         : *s.augmentation == "sixfold" ? tactnet::augmentation_rule::sixfold
                                                        : tactnet::augmentation_rule::each_epoch;
    apply_kinds(r, s);
    return r;
}

std::shared_ptr<pretrained_weights> open_pretrained(const method& what, const training_settings& settings) {
    check_pretrained(what, settings);
    return what.pretrained() ? what.open_pretrained(settings.pretrained) : nullptr;
}
