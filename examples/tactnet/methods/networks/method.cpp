#include "methods/networks/method.hpp"

#include "data/fingerprint.hpp"
#include "methods/description.hpp"
#include "methods/made_up_frames.hpp"
#include "methods/networks/eight_bit/trained.hpp"
#include "methods/networks/looped_training.hpp"
#include "usage_error.hpp"

#include <tactnet/io/model_file.hpp>
#include <tactnet/transfer/pretrained_trunk.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace {

std::string fingerprint_of(std::string_view text) {
    fingerprint print;
    print.add(text);
    return print.text();
}

/// Of images one after the other.
std::vector<float> logits_of(const any_model& model, std::span<const std::uint8_t> images) {
    const std::size_t size = model.mean.size();
    return logits_of(model, tactnet::detail::count_images(images.size(), size),
                     [&](std::size_t i, std::span<float> counts) {
                         std::ranges::copy(images.subspan(i * size, size), counts.begin());
                     });
}

tactnet::stored_arrays stored_arrays_of(const compiled_network& code) {
    return tactnet::stored_arrays_of(code.describe(), code.outputs);
}

any_model load_model(const compiled_network& code, const tactnet::safetensors& file,
                     std::optional<double> epsilon) {
    any_model model{code.make(), {}, 1, {}};
    const tactnet::shape input = model.network->input_shape();
    take(model, tactnet::read_model(file, input, stored_arrays_of(code), epsilon));
    tactnet::check_selftest(file, input, model.classes.size(),
                            [&](std::span<const std::uint8_t> images) { return logits_of(model, images); });
    return model;
}

/// Weights that a network's training begins with: of each array, or none.
class begun_weights final : public pretrained_weights {
public:
    explicit begun_weights(std::vector<std::vector<float>> arrays) : arrays_(std::move(arrays)) {}

    const std::vector<std::vector<float>>& arrays() const { return arrays_; }
    /// All layers are trained, so that trainings have nothing in common.
    bool prepare(const image_data&, const feature_place&, tactnet::thread_pool&) override { return true; }

private:
    std::vector<std::vector<float>> arrays_;
};

class own_trained_network final : public trained_network {
public:
    /// `bytes` may be none.
    own_trained_network(const compiled_network& code, const compiled_eight_bit* bytes, any_model model)
        : code_(code), bytes_(bytes), model_(std::move(model)) {}

    tactnet::trainable& network() const { return *model_.network; }
    const std::vector<std::string>& classes() const override { return model_.classes; }
    tactnet::evaluation evaluate(const tactnet::labelled_images& images, std::span<const std::size_t> chosen,
                                 tactnet::thread_pool& threads) const override {
        return tactnet::evaluate(*model_.network, model_.mean, model_.scale, images, chosen, threads);
    }
    std::optional<tactnet::evaluation> evaluate_reflections(const tactnet::labelled_images& images,
                                                            std::span<const std::size_t> chosen,
                                                            tactnet::thread_pool& threads) const override {
        return tactnet::evaluate(*model_.network, model_.mean, model_.scale, images, chosen, threads,
                                 tactnet::test_time_augmentation::reflections);
    }
    std::vector<scored_class> recognise(std::span<const std::uint8_t> images,
                                        tactnet::thread_pool& threads) const override {
        const auto deployed = code_.deploy(model_);
        const std::size_t count = images.size() / (code_.rows * code_.columns);
        std::vector<float> outputs(count * code_.outputs);
        if (!deployed->recognise(threads, images, outputs))
            refuse_logits();
        return classes_of_rows(outputs, code_.outputs, classes().size(), deployed->gives_probabilities());
    }
    void save(const std::filesystem::path& path, const tactnet::file_metadata& metadata,
              std::span<const std::uint8_t> selftest) const override {
        const auto parts = parts_of(model_, model_.network->input_shape(), stored_arrays_of(code_));
        tactnet::save_model(path, parts, metadata, selftest,
                            [&](std::span<const std::uint8_t> images) { return logits_of(model_, images); });
    }
    std::string header(const tactnet::header_description& says,
                       std::span<const std::uint8_t> frame) const override {
        return code_.deploy(model_)->header(says, frame);
    }
    std::unique_ptr<trained_network> in_eight_bits(const tactnet::labelled_images& images,
                                                   std::span<const std::size_t> chosen) const override {
        if (bytes_ == nullptr)
            return trained_network::in_eight_bits(images, chosen);
        // As a file has it: outputs that stand for no class must not count when ranges are chosen.
        any_model of_classes{model_.network->copy(), model_.mean, model_.scale, model_.classes};
        const tactnet::stored_arrays stored = stored_arrays_of(code_);
        const std::string last = stored.output_layer();
        const auto arrays = arrays_of(*of_classes.network);
        for (std::size_t i = 0; i < arrays.size(); ++i)
            if (!last.empty() && stored.list[i].name.starts_with(last))
                std::ranges::fill(arrays[i].subspan(arrays[i].size() / code_.outputs * classes().size()),
                                  0.0f);
        return make_eight_bit_network(code_, *bytes_, of_classes, images, chosen);
    }

private:
    const compiled_network& code_;
    const compiled_eight_bit* bytes_;
    any_model model_;
};

class own_network_training final : public looped_training {
public:
    own_network_training(const compiled_network& code, const compiled_eight_bit* bytes,
                         const tactnet::recipe& recipe, const tactnet::labelled_images& images,
                         tactnet::data_split split, std::uint64_t seed, tactnet::thread_pool& threads)
        : looped_training(code.make(), recipe, with_variation(code, images), std::move(split), seed, threads),
          code_(code),
          bytes_(bytes) {}

    void start_from(const trained_method& other) override {
        tactnet::trainable& from = dynamic_cast<const own_trained_network&>(other).network();
        loop().start_from(from.learnable_values(), from.running_statistics());
    }
    void start_from(const begun_weights& weights) { loop().start_from_trunk(weights.arrays()); }
    std::unique_ptr<trained_method> best(const std::vector<std::string>& classes) const override {
        return std::make_unique<own_trained_network>(code_, bytes_, best_model(classes));
    }

private:
    static tactnet::labelled_images with_variation(const compiled_network& code,
                                                   tactnet::labelled_images images) {
        images.taken.vary = code.variation_of(images.taken.taken);
        return images;
    }

    const compiled_network& code_;
    const compiled_eight_bit* bytes_;
};

class network_method final : public method {
public:
    network_method(std::string_view network, std::unique_ptr<compiled_network> code, std::string_view type,
                   std::optional<tactnet::published_training> training,
                   std::unique_ptr<compiled_eight_bit> bytes)
        : method(network, code->rows, code->columns, code->outputs, training),
          type_(type),
          code_(std::move(code)),
          bytes_(std::move(bytes)) {}

    bool is_network() const override { return true; }
    std::string declaration() const override {
        return fmt::format("{}<tactnet::shape{{{}, {}}}, {}>", type_, rows, columns, code_->outputs);
    }
    std::optional<pretrained_file> pretrained() const override {
        const auto* const found =
            std::ranges::find_if(photograph_networks::all, [&](const photograph_network& n) {
                return name == std::string(n.name) + "-nn";
            });
        if (found == photograph_networks::all.end())
            return std::nullopt;
        const std::size_t of_photograph = 2; // arrays in front, which are no weights
        return pretrained_file{*found, code_->describe().at(of_photograph).name,
                               code_->costs.parameter_bytes};
    }
    std::shared_ptr<pretrained_weights> open_pretrained(const std::filesystem::path& path) const override {
        auto file = tactnet::safetensors_source::open(path);
        const auto form = tactnet::stored_photograph_preprocessing(file);
        return std::make_shared<begun_weights>(
            tactnet::pretrained_trunk(file, stored_arrays_of(*code_), form));
    }
    tactnet::recipe default_recipe() const override {
        if (pretrained() && published)
            return tactnet::recipe::fine_tuning(*published);
        tactnet::recipe r = method::default_recipe();
        if (code_->takes_counts)
            r.input = tactnet::input_rule::scale;
        return r;
    }
    tactnet::file_metadata parts() const override {
        return type_.starts_with("tactnet::")
                   ? tactnet::file_metadata{}
                   : tactnet::file_metadata{{"type", fingerprint_of(code_->type())}};
    }

    method_costs costs(std::size_t classes) const override {
        return costs_for(code_->costs, code_->costs_of_one, code_->outputs, classes);
    }

    bool varies_as_taken(const tactnet::shape& taken) const override {
        return code_->variation_of(taken) != nullptr;
    }
    bool has_eight_bit_form() const override { return bytes_ != nullptr; }
    bool may_have_eight_bit_form() const override { return !pretrained(); }
    std::size_t eight_bit_bytes(std::size_t classes) const override {
        return eight_bit_parameter_bytes(*bytes_, classes);
    }
    frame_work make_work(std::size_t bits) const override {
        any_model model{code_->make(), std::vector<float>(rows * columns), 1, {}};
        draw_arrays(*model.network);
        std::shared_ptr<any_deployed> deployed =
            bits == 8 ? bytes_->deploy(bytes_->calibrate(model, made_up_frames(4 * rows * columns)).folded)
                      : code_->deploy(model);
        return
            [deployed = std::move(deployed), pixels = rows * columns, outputs = code_->outputs,
             frames = std::vector<std::uint8_t>(), logits = std::vector<float>()](std::size_t count) mutable {
                if (frames.size() != count * pixels) {
                    frames = made_up_frames(count * pixels);
                    logits.resize(count * outputs);
                }
                tactnet::thread_pool alone;
                if (!deployed->recognise(alone, frames, logits))
                    throw std::runtime_error("expected finite logits of the frames that are timed");
            };
    }

    std::unique_ptr<training_run> train(const tactnet::recipe& recipe, const tactnet::labelled_images& images,
                                        tactnet::data_split split, std::uint64_t seed,
                                        tactnet::thread_pool& threads,
                                        const std::shared_ptr<pretrained_weights>& from) const override {
        auto training = std::make_unique<own_network_training>(*code_, bytes_.get(), recipe, images,
                                                               std::move(split), seed, threads);
        if (from)
            training->start_from(dynamic_cast<const begun_weights&>(*from));
        return training;
    }

    std::unique_ptr<trained_method> load(const weight_file& file,
                                         std::optional<double> epsilon) const override {
        if (!tactnet::describe_model(file.arrays).bits)
            return std::make_unique<own_trained_network>(*code_, bytes_.get(),
                                                         load_model(*code_, file.arrays, epsilon));
        if (!bytes_)
            throw tactnet::file_error(
                file.arrays.file(), "metadata 'bits'",
                "weights in single precision, or a network whose form in 8 bits was compiled in (chosen when "
                "building, by TACTNET_PROGRAM_EIGHT_BIT)",
                fmt::format("'8', of {} {}x{}", name, rows, columns));
        if (epsilon)
            throw usage_error(
                "--epsilon: expected weights in single precision, found 8 bits, into which batch "
                "norms are folded");
        return load_eight_bit_network(*code_, *bytes_, file.arrays);
    }

private:
    std::string type_;
    std::unique_ptr<compiled_network> code_;
    std::unique_ptr<compiled_eight_bit> bytes_;
};

} // namespace

std::unique_ptr<method> make_network_method(std::string_view name, std::unique_ptr<compiled_network> code,
                                            std::string_view type,
                                            std::optional<tactnet::published_training> published,
                                            std::unique_ptr<compiled_eight_bit> bytes) {
    return std::make_unique<network_method>(name, std::move(code), type, published, std::move(bytes));
}
