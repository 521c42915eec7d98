#include "methods/weights.hpp"

#include "console.hpp"
#include "data/input_file.hpp"
#include "methods/description.hpp"
#include "methods/networks/compiled.hpp"
#include "methods/registry.hpp"
#include "methods/trunks/compiled.hpp"
#include "number_options.hpp"

#include <tactnet/io/safetensors/writer.hpp>
#include <tactnet/text/message.hpp>

#include <system_error>

void add_weight_options(CLI::App& command, weight_options& o, bool required) {
    command.add_option("--weights", o.weights, "Weight file (safetensors)")
        ->type_name("FILE")
        ->required(required);
    if (required) { // elsewhere these exist already, for other purposes too
        command.add_option("--method", o.method,
                           "The method, if the weight file does not state it: one of " + method_names());
        add_option(command, "--rows", o.rows, whole_number(1, 4096),
                   "Rows of an image, if the weight file does not state them");
        add_option(command, "--columns", o.columns, whole_number(1, 4096),
                   "Columns of an image, if the weight file does not state them");
        add_image_options(command, o.images);
    }
    add_option(command, "--epsilon", o.epsilon, positive_number(),
               "Epsilon that batch norms add to the variance (default: the file's, otherwise 1e-5)");
    command
        .add_option(
            "--classes", o.classes,
            "Class names: a text file with one name per line, or a folder with one subfolder per class "
            "(default: the file's, otherwise class_00, class_01, ...)")
        ->check([](const std::string& path) {
            return path.empty() ? std::string("expected a file or a folder of names, found ''")
                                : std::string();
        });
}

namespace {

/// The file as it is; if it holds a trunk, without that.
weight_file read_weight_file(const std::string& path) {
    std::shared_ptr<tactnet::safetensors_source> source;
    std::error_code code;
    if (std::filesystem::is_regular_file(path, code)) {
        try {
            source = std::make_shared<tactnet::safetensors_source>(
                tactnet::safetensors_source::open(path, tactnet::checksum_rule::ignore));
        } catch (const tactnet::file_error&) { // reported below
        }
    }
    const auto is_of_trunk = [](const std::string& name) { return name.starts_with(trunk_prefix); };
    if (!source || std::ranges::none_of(source->tensors(), is_of_trunk,
                                        [](const auto& tensor) -> const auto& { return tensor.first; }))
        return {tactnet::safetensors::read(path), nullptr};
    *source = tactnet::safetensors_source::open(path);
    tactnet::safetensors_writer rest;
    rest.metadata = source->metadata();
    for (const auto& [name, tensor] : source->tensors()) {
        if (is_of_trunk(name))
            continue;
        std::vector<std::byte> bytes;
        source->read_bytes(name, [&](std::span<const std::byte> piece) {
            bytes.insert(bytes.end(), piece.begin(), piece.end());
        });
        rest.add(name, tensor.type, tensor.extents, bytes);
    }
    return {tactnet::safetensors::parse(rest.to_bytes(), path), std::move(source)};
}

} // namespace

loaded_weights load_weights(const weight_options& o) {
    check_no_device(o.weights);
    const weight_file whole = read_weight_file(o.weights);
    const tactnet::safetensors& file = whole.arrays;
    if ((whole.trunk ? whole.trunk->checksum() : file.checksum()) == tactnet::checksum_state::absent)
        tell("{}: no checksum in it, so that damage may go unnoticed\n", printable(o.weights));
    const tactnet::model_description says = tactnet::describe_model(file);
    const std::string name = o.method.empty() ? says.network : o.method;
    const auto rows = o.rows ? o.rows : says.rows, columns = o.columns ? o.columns : says.columns;
    if (name.empty() || !rows || !columns)
        refuse("{}: expected metadata that say which method it is for, or --method, --rows and --columns, "
               "found neither",
               o.weights);
    if (!says.network.empty() && says.network != name)
        refuse("{}: expected weights of {} as --method says, found those of {}", o.weights, name,
               says.network);
    const method& what = find_method(name, fmt::format("{}x{}", *rows, *columns));
    if (!what.is_network() && o.epsilon)
        refuse("--epsilon: expected a network, found {}, which has no batch norms", name);
    loaded_weights result{&what, nullptr, {}, !says.classes.empty() || !o.classes.empty(), file.metadata()};
    result.trained = result.what->load(whole, o.epsilon);
    result.classes = result.trained->classes();
    if (!o.classes.empty()) {
        std::vector<std::string> names = load_class_names(o.classes);
        if (names.size() != result.classes.size())
            refuse("{}: expected {} class names, as {} has, found {}", o.classes, result.classes.size(),
                   o.weights, names.size());
        result.classes = std::move(names);
    }
    return result;
}

std::shared_ptr<const trained_method> load_start(const method& what, const training_settings& settings,
                                                 const std::vector<std::string>& classes) {
    if (settings.start.empty())
        return nullptr;
    weight_options options;
    options.weights = settings.start, options.method = what.name;
    options.rows = what.rows, options.columns = what.columns;
    loaded_weights loaded = load_weights(options);
    if (loaded.trained->bits() == 8)
        refuse("{}: metadata 'bits': expected weights in single precision to begin with, found '8'",
               settings.start);
    if (loaded.classes != classes)
        refuse(
            "{}: expected the {} classes of the images, by the same names, found {} classes, or other names",
            settings.start, classes.size(), loaded.classes.size());
    const auto says = loaded.metadata.find("input");
    const std::string wanted = describe_method(what, recipe_for(what, settings)).at("input");
    if (says != loaded.metadata.end() && says->second != wanted)
        refuse("--start: expected a network of inputs by '{}', found one by '{}'; see --input", wanted,
               says->second);
    return std::move(loaded.trained);
}

void start(training_run& training, const trained_method* from) {
    if (from != nullptr)
        dynamic_cast<epoch_training&>(training).start_from(*from);
}

std::unique_ptr<trained_network> in_eight_bits(const trained_method& trained,
                                               const tactnet::labelled_images& images,
                                               std::span<const std::size_t> chosen) {
    try {
        return dynamic_cast<const trained_network&>(trained).in_eight_bits(images, chosen);
    } catch (const std::invalid_argument& error) { // numbers without end, images that are broken
        refuse("--bits: {}", error.what());
    }
}

tactnet::data_split stored_split(const std::string& file, const tactnet::file_metadata& metadata,
                                 const std::string& folder, const image_data& data) {
    const auto text_in = [&](const char* key) -> const std::string& {
        const auto found = metadata.find(key);
        if (found == metadata.end())
            refuse("{}: metadata '{}': expected that of a training, or --images all, found none", file, key);
        return found->second;
    };
    const auto number_in = [&](const char* key, const char* expected, auto read) {
        const auto value = read(text_in(key));
        if (!value)
            refuse("{}: metadata '{}': expected {}, found {}", file, key, expected,
                   tactnet::in_quotes(text_in(key)));
        return *value;
    };
    const auto share_in = [&](const char* key) {
        return number_in(key, "a share from 0 to below 1", [](const std::string& text) {
            const auto value = number_of(text);
            return value && is_share(*value) ? value : std::nullopt;
        });
    };
    const std::uint64_t seed = number_in("seed", "a whole number below 2^64", whole_number_of);
    training_settings trained;
    trained.shares = {share_in("validation_share"), share_in("test_share")};
    if (!is_share(trained.shares.validation + trained.shares.test))
        refuse("{}: metadata: expected shares that leave some images for training, found {} to validate and "
               "{} to test",
               file, trained.shares.validation, trained.shares.test);
    const std::string &split = text_in("split"), &trained_on = text_in("data");
    const auto require = [&](const char* what, const std::string& expected, const std::string& found,
                             const char* options) {
        if (expected != found)
            refuse("{}: expected the {} that {} was trained on (fingerprint {}), or --images all, found "
                   "others ({}){}",
                   folder, what, file, expected, found, options);
    };
    require("images", trained_on, data.fingerprint, "");
    if (std::ranges::none_of(split_rule_names, [&](const auto& known) { return known.first == split; }))
        refuse("{}: metadata 'split': expected a split such as random or grouped, found {}", file,
               tactnet::in_quotes(split));
    if (metadata.contains("groups"))
        require("groups", text_in("groups"), data.groups_fingerprint,
                "; give --group, --group-folders or --table as in training");
    if (metadata.contains("given"))
        require("split", text_in("given"), data.given_fingerprint, "; give --table as in training");
    if (metadata.contains("folds"))
        trained.folds = number_in("folds", "a whole number", whole_number_of);
    return split_for(data, trained, split_rule_for(split, data), seed);
}
