#pragma once

// Everything that is compiled for a network's type and size, as functions. The program knows networks by this
// alone, so that all else is compiled once. compile.hpp has the templates behind it.

#include "methods/method.hpp"

#include <tactnet/deployment/eight_bit/layout.hpp>
#include <tactnet/io/save_model.hpp>
#include <tactnet/training/loop.hpp>
#include <tactnet/training/loop/trainable.hpp>

#include <algorithm>
#include <functional>

/// A network of any type, with everything it takes to recognise.
struct any_model {
    std::unique_ptr<tactnet::trainable> network;
    std::vector<float> mean;
    float scale = 1;
    std::vector<std::string> classes;
    double temperature = 1; ///< see tactnet::model
    tactnet::input_function function{};
    tactnet::reflection_rule reflections = tactnet::reflection_rule::all();
};

/// A network in its fastest form, see tactnet::deploy.
class any_deployed {
public:
    virtual ~any_deployed() = default;
    /// A row of outputs for each of the frames, one after the other. False for outputs that are not finite.
    virtual bool infer(tactnet::thread_pool& threads, std::span<const std::uint8_t> frames,
                       std::span<float> outputs) const = 0;
    /// Whether outputs are probabilities, of a network that ends in a softmax; else they are logits.
    virtual bool gives_probabilities() const = 0;
    /// The class of each frame, and its probability at the network's temperature. Throws std::runtime_error
    /// for outputs that are not finite.
    virtual std::vector<scored_class> classify(tactnet::thread_pool& threads,
                                               std::span<const std::uint8_t> frames) const = 0;
    /// See tactnet::deployed_header.
    virtual std::string header(const tactnet::header_description& says,
                               std::span<const std::uint8_t> frame) const = 0;
};

struct compiled_network {
    tactnet::shape input;
    std::size_t outputs;
    method_costs costs, costs_of_one; ///< with all outputs, and with one alone
    bool needs_counts;                ///< see tactnet::basic_network
    std::string_view type;            ///< as the compiler spells it: everything that decides what it computes
    std::unique_ptr<tactnet::trainable> (*make)();
    std::vector<tactnet::parameter> (*describe)();
    /// Throws std::invalid_argument for parameters that cannot be deployed.
    std::unique_ptr<any_deployed> (*deploy)(const any_model& model);
    /// The bytes of an ONNX file; null for a network that has no such form.
    std::string (*onnx)(const any_model& model);
    /// How images of that size are varied and reduced; null where that was not compiled in.
    tactnet::images_as_taken::variation (*variation_of)(const tactnet::shape& taken);

    std::size_t pixels() const { return input.size(); }
    tactnet::stored_arrays arrays() const { return tactnet::stored_arrays_of(describe(), outputs); }
    /// Outputs that stand for no class are no part of the network, and each costs the same.
    method_costs costs_for(std::size_t classes) const;
};

/// The result of calibration.
struct calibrated_numbers {
    std::vector<float> folded;
    /// Root mean square differences of outputs from single precision: with these weights, and merely rounded.
    double output_error, output_error_of_rounded;
};

/// A network's form in 8 bits.
class compiled_eight_bit {
public:
    virtual ~compiled_eight_bit() = default;
    virtual tactnet::folded_layout layout() const = 0;
    /// Ranges and weights from images. Throws std::invalid_argument for a model that has no form in 8 bits.
    virtual calibrated_numbers calibrate(const any_model& model,
                                         std::span<const std::uint8_t> images) const = 0;
    /// Throws std::invalid_argument for numbers that cannot be. Without names, each output is a class.
    virtual std::unique_ptr<any_deployed> deploy(std::span<const float> folded,
                                                 const std::vector<std::string>& classes, double temperature,
                                                 const tactnet::input_function& function,
                                                 const tactnet::reflection_rule& reflections) const = 0;
};

/// `type`: without what is between the brackets: "tactnet::tactnet6". `published`: the authors' training, if
/// any. `bytes`: its form in 8 bits, or null.
std::unique_ptr<method> make_network_method(std::string_view name, const compiled_network& code,
                                            std::string_view type,
                                            std::optional<tactnet::published_training> published,
                                            std::unique_ptr<compiled_eight_bit> bytes);

/// The values of each array, in the order of `describe`.
std::vector<std::span<float>> arrays_of(tactnet::trainable& network);
/// Random parameters, for timing.
void draw_arrays(tactnet::trainable& network);

/// A view of the model as a file has it, without a self-test; `image` is the shape of the file's images.
tactnet::model_parts parts_of(const any_model& model, tactnet::shape image, tactnet::stored_arrays arrays);
/// A model with the contents of a file. Rows of outputs that stand for no class become zero, and so does a
/// mean that is not stored. Throws tactnet::file_error.
any_model load_model(const compiled_network& code, const tactnet::safetensors& file, tactnet::shape image,
                     std::optional<double> epsilon);

/// A row for each of `count` samples, one number a class. make(i, numbers) writes sample i.
std::vector<float> logits_of(const any_model& model, std::size_t count,
                             const std::function<void(std::size_t, std::span<float>)>& make);
/// A row of all outputs for each frame. Throws std::runtime_error for outputs that are not finite.
std::vector<float> outputs_of(const any_deployed& network, const compiled_network& code,
                              std::span<const std::uint8_t> frames, tactnet::thread_pool& threads);
/// Logits: of a network that ends in a softmax the logarithms of its outputs, finite for zero.
std::vector<float> logits_of(const any_deployed& network, const compiled_network& code,
                             std::span<const std::uint8_t> frames, tactnet::thread_pool& threads);
/// For outputs that are not finite.
[[noreturn]] void refuse_logits();

/// A training by epochs. `finish` makes a trained method of its best network, and lives as long.
class epoch_training final : public training_run {
public:
    using finisher = std::function<std::unique_ptr<trained_method>(any_model)>;

    epoch_training(std::unique_ptr<tactnet::trainable> network, const tactnet::recipe& recipe,
                   const tactnet::labelled_samples& samples, tactnet::data_split split, std::uint64_t seed,
                   tactnet::thread_pool& threads, finisher finish)
        : loop_(std::move(network), recipe, samples, std::move(split), seed, threads),
          finish_(std::move(finish)) {}

    tactnet::training_loop& loop() { return loop_; }
    bool finished() const override { return loop_.finished(); }
    void advance() override; // not inline: it is to be compiled once, optimised
    const std::vector<tactnet::epoch_report>& history() const { return loop_.history(); }
    std::size_t images_per_epoch() const { return loop_.samples_per_epoch(); }
    const tactnet::data_split& split() const override { return loop_.split(); }
    /// Before the first epoch: begins with a network that the same method has loaded.
    void start_from(const trained_method& other);
    void save_checkpoint(const std::filesystem::path& path, const tactnet::file_metadata& settings);
    /// Returns what is known of the file's checksum.
    tactnet::checksum_state load_checkpoint(const std::filesystem::path& path,
                                            const tactnet::file_metadata& settings);
    std::unique_ptr<trained_method> best(const std::vector<std::string>& classes) const override;

private:
    tactnet::training_loop loop_;
    finisher finish_;
};
