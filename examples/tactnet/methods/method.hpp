#pragma once

// A method is what --method names: a network or a support vector machine, at one size. The program knows it
// by names and virtual functions; what only networks can do is in interfaces of their own. Headers that
// include this one do not repeat its includes.

#include <tactnet/deployment/export/header_description.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/networks/published.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/shape.hpp>
#include <tactnet/training/choose_augmentation.hpp>
#include <tactnet/training/data/split.hpp>
#include <tactnet/training/evaluate.hpp>
#include <tactnet/training/recipe.hpp>
#include <tactnet/training/trainer.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

struct image_data;

/// A network that others have trained on photographs, which methods begin with.
struct photograph_network {
    std::string_view name;        ///< in the names of methods: "squeezenet"
    std::string_view title;       ///< in sentences: "SqueezeNet 1.1"
    std::string_view torchvision; ///< what makes it there: "squeezenet1_1"
    tactnet::shape photograph;    ///< what it was trained on
};
inline constexpr std::array photograph_networks{
    photograph_network{"squeezenet", "SqueezeNet 1.1", "squeezenet1_1", {227, 227, 3}},
    photograph_network{"alexnet", "AlexNet", "alexnet", {224, 224, 3}},
    photograph_network{"resnet50", "ResNet-50", "resnet50", {224, 224, 3}},
    photograph_network{"vgg16", "VGG16", "vgg16", {224, 224, 3}},
};

/// The file that a method needs, for sentences.
struct pretrained_file {
    photograph_network network;
    std::string array; ///< one that must be in it: "features.0.weight"
    std::size_t bytes; ///< that its arrays take in single precision
};

/// Such a file, opened by a method and found to fit it.
class pretrained_weights {
public:
    virtual ~pretrained_weights() = default;
    /// Computes what all trainings on these images have in common, and keeps it in a folder unless that is no
    /// name. Returns false if it was interrupted. The images must outlive this.
    virtual bool prepare(const image_data&, const std::filesystem::path&, tactnet::thread_pool&) {
        return true;
    }
};

/// What one frame costs, in a method for a number of classes.
struct method_costs {
    std::size_t parameters = 0;              ///< weights, biases, scales and shifts
    std::size_t multiply_adds = 0;           ///< all taps
    std::size_t multiply_adds_on_pixels = 0; ///< without those on padding
    std::size_t parameter_bytes = 0;         ///< with running statistics, in single precision
    std::size_t activation_bytes = 0;
};

/// With all outputs of a network.
template <class Network>
constexpr method_costs costs_of() {
    return {Network::parameters, Network::multiply_adds, Network::multiply_adds_on_pixels,
            Network::parameter_bytes, Network::activation_bytes};
}

/// Recognises that many frames together on one thread, to be timed; the first call makes room for them.
using frame_work = std::function<void(std::size_t frames)>;

/// What an image was taken for. Not tactnet::recognition, whose probability not every method has.
struct scored_class {
    std::size_t label = 0;
    /// The probability of a network, or a machine's smallest decision value in favour of the class, which has
    /// no upper bound and is above 0 where no decision went against it.
    double score = 0;
};

/// A weight file.
struct weight_file {
    tactnet::safetensors arrays; ///< all of it but for a trunk
    /// The same file on the disk, where it holds a trunk, which may be large.
    std::shared_ptr<tactnet::safetensors_source> trunk{};
};

/// Touches of 22 sizes in turn, for timing and self-tests, which hold nobody's recordings: always the same
/// bits.
std::vector<std::uint8_t> made_up_touches(std::size_t count, tactnet::extent2d image);

struct any_model;

/// What a training leaves: a network with its weights, or a support vector machine with its features.
class trained_method {
public:
    virtual ~trained_method() = default;
    /// Its parameters, of a network in single precision; else null.
    virtual const any_model* model() const { return nullptr; }
    /// Bits of a weight: 8, or 32 in single precision.
    virtual std::size_t bits() const { return 32; }
    virtual const std::vector<std::string>& classes() const = 0;
    /// The reflections over which it averages its answers, if asked; nothing for what does not do that.
    virtual std::optional<tactnet::reflection_rule> reflections() const { return std::nullopt; }
    /// The loss of a support vector machine is NaN, and it has no logits.
    virtual tactnet::evaluation evaluate(const tactnet::labelled_images& images,
                                         std::span<const std::size_t> chosen, tactnet::thread_pool& threads,
                                         const tactnet::test_time_augmentation& how = {}) const = 0;
    /// The temperature of a network's probabilities, see tactnet::model.
    virtual double temperature() const { return 1; }
    /// Of images that are stored one after the other.
    virtual std::vector<scored_class> recognise(std::span<const std::uint8_t> images,
                                                tactnet::thread_pool& threads) const = 0;
    virtual void save(const std::filesystem::path& path, const tactnet::file_metadata& metadata,
                      std::span<const std::uint8_t> selftest) const = 0;
};

/// One that becomes a C++ header.
class trained_network : public trained_method {
public:
    /// The text of a C++ header with the deployed network and a frame to test it. Throws
    /// std::invalid_argument for weights that cannot be deployed.
    virtual std::string header(const tactnet::header_description& says,
                               std::span<const std::uint8_t> frame) const = 0;
    /// The bytes of an ONNX file; empty for a network that has no such form, as in 8 bits.
    virtual std::string onnx() const { return {}; }
    /// What a conversion to 8 bits has just done to its outputs, as a sentence.
    virtual std::string calibration() const { return {}; }
    /// For methods with has_eight_bit_form; the chosen images set the ranges of its maps. Throws
    /// std::invalid_argument for weights that cannot be converted.
    virtual std::unique_ptr<trained_network> in_eight_bits(const tactnet::labelled_images&,
                                                           std::span<const std::size_t>) const {
        throw std::logic_error("a network without a form in 8 bits was asked for it");
    }
};

/// A training in progress.
class training_run {
public:
    virtual ~training_run() = default;
    virtual bool finished() const = 0;
    /// One epoch of a network, all of a support vector machine.
    virtual void advance() = 0;
    virtual const tactnet::data_split& split() const = 0;
    /// The best so far.
    virtual std::unique_ptr<trained_method> best(const std::vector<std::string>& classes) const = 0;
};

/// A method at one size.
class method {
public:
    method(std::string_view name_, std::size_t rows_, std::size_t columns_, std::size_t capacity_,
           std::optional<tactnet::published_training> published_ = {})
        : name(name_), rows(rows_), columns(columns_), capacity(capacity_), published(published_) {}
    virtual ~method() = default;

    const std::string name;
    const std::size_t rows, columns;
    const std::size_t capacity; ///< the largest number of classes
    const std::optional<tactnet::published_training> published;

    /// "28x50".
    std::string size() const { return std::to_string(rows) + "x" + std::to_string(columns); }
    /// Not a support vector machine.
    virtual bool is_network() const = 0;
    /// Such a network can be trained by the thorough recipe, and be converted to 8 bits.
    bool begins_at_random() const { return is_network() && !pretrained(); }

    /// Its type in C++ for so many classes, of a network that is one type:
    /// "tactnet::tactnet6<tactnet::shape{28, 50}, 22>".
    virtual std::string declaration(std::size_t /*classes*/) const { return {}; }
    /// What it is, for sentences.
    virtual std::string_view kind() const { return is_network() ? "network" : "support vector machine"; }
    /// For a network, the recipe that did best, or the authors' if none was looked for.
    virtual tactnet::recipe default_recipe() const { return tactnet::recipe::default_for(rows, columns); }
    /// What it is made of, where its name does not say it: features, settings of a machine, a user's layers.
    virtual tactnet::file_metadata parts() const { return {}; }
    virtual method_costs costs(std::size_t classes) const = 0;
    /// Whether its training varies images of that size as they were taken.
    virtual bool augment_full_resolution(const tactnet::shape&) const { return false; }
    /// Whether its form in 8 bits was compiled in.
    virtual bool has_eight_bit_form() const { return false; }
    /// Bytes of weights of 8 bits with all that belongs to them.
    virtual std::size_t eight_bit_bytes(std::size_t) const { return 0; }
    /// With random weights, since there may be no others; in 8 bits only with has_eight_bit_form.
    virtual frame_work make_work(std::size_t bits = 32) const = 0;
    /// The size of the batch that is timed in addition to a single frame. Photographs pass in batches of 16.
    std::size_t frames_together() const { return pretrained() ? 16 : 64; }
    /// The network that others have trained on photographs and that it begins with, if it does.
    virtual std::optional<pretrained_file> pretrained() const { return std::nullopt; }
    /// Whether a network that is not trained computes features of images, once for all trainings.
    virtual bool keeps_features() const { return false; }
    /// Opens the file of it. Throws tactnet::file_error; for methods that need one alone.
    virtual std::shared_ptr<pretrained_weights> open_pretrained(const std::filesystem::path&) const = 0;
    /// The recipe with the augmentation that suits the training images (tactnet::choose_augmentation), by
    /// mean images alone or by `trials` too, but for what is fixed.
    virtual tactnet::augmentation_choice
    choose(const tactnet::recipe& recipe, const image_data&, std::span<const std::size_t> training,
           std::uint64_t seed, tactnet::thread_pool&, bool trials, const tactnet::fixed_augmentation&,
           const tactnet::search_stop& stop, tactnet::trial_scores* known) const {
        static_cast<void>(training), static_cast<void>(seed), static_cast<void>(trials);
        static_cast<void>(stop), static_cast<void>(known);
        return {recipe, {}, {}};
    }
    /// The images must outlive the training. Support vector machines have settings of their own in place of
    /// the recipe. `from`: what open_pretrained gave, if the method needs it.
    virtual std::unique_ptr<training_run> train(const tactnet::recipe& recipe,
                                                const tactnet::labelled_images& images,
                                                tactnet::data_split split, std::uint64_t seed,
                                                tactnet::thread_pool& threads,
                                                const std::shared_ptr<pretrained_weights>& from) const = 0;
    /// `epsilon` of batch norms, where there are any, goes before the file's. Throws tactnet::file_error and
    /// usage_error.
    virtual std::unique_ptr<trained_method> load(const weight_file& file,
                                                 std::optional<double> epsilon) const = 0;
};
