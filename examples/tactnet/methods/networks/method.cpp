// Networks as methods, trained from random weights or from weights learnt from photographs; and in 8 bits.

#include "console.hpp"
#include "data/input_file.hpp"
#include "methods/description.hpp"
#include "methods/networks/compiled.hpp"

#include <tactnet/io/eight_bit_file.hpp>
#include <tactnet/transfer/networks.hpp>

#include <interrupt.hpp>

namespace {

/// Of images one after the other.
std::vector<float> logits_of(const any_model& model, std::span<const std::uint8_t> images) {
    const std::size_t size = model.mean.size();
    return logits_of(model, tactnet::detail::count_images(images.size(), size),
                     [&](std::size_t i, std::span<float> counts) {
                         std::ranges::copy(images.subspan(i * size, size), counts.begin());
                     });
}

/// The arrays that a network's training begins with, empty for those that are drawn.
struct begun_weights final : pretrained_weights {
    std::vector<std::vector<float>> arrays;
};

/// A network in 8 bits.
class eight_bit_network final : public trained_network {
public:
    eight_bit_network(const compiled_network& code, const compiled_eight_bit& bytes,
                      std::vector<float> folded, std::vector<std::string> classes, double temperature,
                      const tactnet::input_function& function, tactnet::reflection_rule reflections,
                      std::string calibration = {})
        : code_(code),
          layout_(bytes.layout()),
          folded_(std::move(folded)),
          classes_(std::move(classes)),
          temperature_(temperature),
          function_(function),
          reflections_(std::move(reflections)),
          calibration_(std::move(calibration)),
          deployed_(bytes.deploy(folded_, classes_, temperature, function, reflections_)) {}

    std::size_t bits() const override { return 8; }
    const std::vector<std::string>& classes() const override { return classes_; }
    std::string calibration() const override { return calibration_; }
    std::optional<tactnet::reflection_rule> reflections() const override { return reflections_; }
    tactnet::evaluation evaluate(const tactnet::labelled_images& images, std::span<const std::size_t> chosen,
                                 tactnet::thread_pool& threads,
                                 const tactnet::test_time_augmentation& how) const override {
        // Counts as they are.
        const std::size_t pixels = code_.pixels();
        const std::vector<float> mean(pixels);
        return tactnet::detail::evaluate(
            layout_.input, mean, 1, code_.outputs, images, chosen, how,
            [&](const tactnet::sample_batch& in, tactnet::sample_batch& out) {
                std::vector<std::uint8_t> frames;
                for (std::size_t i = 0; i < in.samples(); ++i)
                    for (std::size_t e = 0; e < pixels; ++e)
                        frames.push_back(static_cast<std::uint8_t>(in(i, e)));
                const std::vector<float> found = logits_of(*deployed_, code_, frames, threads);
                for (std::size_t i = 0; i < in.samples(); ++i)
                    out.set(i, std::span(found).subspan(i * code_.outputs, code_.outputs));
            });
    }
    double temperature() const override { return temperature_; }
    std::vector<scored_class> recognise(std::span<const std::uint8_t> images,
                                        tactnet::thread_pool& threads) const override {
        return deployed_->classify(threads, images);
    }
    void save(const std::filesystem::path& path, const tactnet::file_metadata& metadata,
              std::span<const std::uint8_t> selftest) const override {
        tactnet::safetensors_writer writer;
        writer.metadata = metadata;
        tactnet::add_deployed(
            writer, layout_, folded_, classes_, selftest,
            [&](std::span<const std::uint8_t> images) { return logits(images); }, temperature_, function_,
            reflections_);
        writer.write(path);
    }
    std::string header(const tactnet::header_description& says,
                       std::span<const std::uint8_t> frame) const override {
        return deployed_->header(says, frame);
    }
    /// Throws tactnet::file_error when images in the file do not give their outputs.
    void check_selftest(const tactnet::safetensors& file) const {
        tactnet::check_deployed(file, layout_.input, classes_.size(),
                                [&](std::span<const std::uint8_t> images) { return logits(images); });
    }

private:
    /// The outputs of the classes alone, as the network gives them.
    std::vector<float> logits(std::span<const std::uint8_t> images) const {
        tactnet::thread_pool alone;
        const std::vector<float> all = outputs_of(*deployed_, code_, images, alone);
        std::vector<float> some;
        for (std::size_t i = 0; i < all.size(); ++i)
            if (i % code_.outputs < classes_.size())
                some.push_back(all[i]);
        return some;
    }

    const compiled_network& code_;
    tactnet::folded_layout layout_;
    std::vector<float> folded_;
    std::vector<std::string> classes_;
    double temperature_;
    tactnet::input_function function_;
    tactnet::reflection_rule reflections_;
    std::string calibration_;
    std::unique_ptr<any_deployed> deployed_;
};

/// A network in single precision.
class own_trained_network final : public trained_network {
public:
    /// `bytes` may be null.
    own_trained_network(const compiled_network& code, const compiled_eight_bit* bytes, any_model model)
        : code_(code), bytes_(bytes), model_(std::move(model)) {}

    const any_model* model() const override { return &model_; }
    const std::vector<std::string>& classes() const override { return model_.classes; }
    std::optional<tactnet::reflection_rule> reflections() const override { return model_.reflections; }
    tactnet::evaluation evaluate(const tactnet::labelled_images& images, std::span<const std::size_t> chosen,
                                 tactnet::thread_pool& threads,
                                 const tactnet::test_time_augmentation& how) const override {
        return tactnet::evaluate(*model_.network, model_.mean, model_.scale, images, chosen, threads, how,
                                 model_.function);
    }
    double temperature() const override { return model_.temperature; }
    std::vector<scored_class> recognise(std::span<const std::uint8_t> images,
                                        tactnet::thread_pool& threads) const override {
        return code_.deploy(model_)->classify(threads, images);
    }
    void save(const std::filesystem::path& path, const tactnet::file_metadata& metadata,
              std::span<const std::uint8_t> selftest) const override {
        tactnet::save_model(path, parts_of(model_, code_.input, code_.arrays()), metadata, selftest,
                            [&](std::span<const std::uint8_t> images) { return logits_of(model_, images); });
    }
    std::string header(const tactnet::header_description& says,
                       std::span<const std::uint8_t> frame) const override {
        return code_.deploy(model_)->header(says, frame);
    }
    std::string onnx() const override { return code_.onnx == nullptr ? std::string() : code_.onnx(model_); }
    std::unique_ptr<trained_network> in_eight_bits(const tactnet::labelled_images& images,
                                                   std::span<const std::size_t> chosen) const override {
        if (bytes_ == nullptr)
            return trained_network::in_eight_bits(images, chosen);
        // As a file has it: outputs that stand for no class must not count when ranges are chosen.
        any_model of_classes{model_.network->copy(), model_.mean,     model_.scale,      model_.classes,
                             model_.temperature,     model_.function, model_.reflections};
        const tactnet::stored_arrays stored = code_.arrays();
        const std::string last(stored.output_layer());
        const auto arrays = arrays_of(*of_classes.network);
        for (std::size_t i = 0; i < arrays.size(); ++i)
            if (!last.empty() && stored.list[i].name.starts_with(last))
                std::ranges::fill(arrays[i].subspan(arrays[i].size() / code_.outputs * classes().size()),
                                  0.0f);
        std::vector<std::uint8_t> shown;
        for (const std::size_t i : chosen) {
            const auto image = images.pixels.subspan(i * code_.pixels(), code_.pixels());
            shown.insert(shown.end(), image.begin(), image.end());
        }
        calibrated_numbers found = bytes_->calibrate(of_classes, shown);
        return std::make_unique<eight_bit_network>(
            code_, *bytes_, std::move(found.folded), classes(), temperature(), model_.function,
            model_.reflections,
            fmt::format("outputs differ by {:.2g} from those in single precision, by {:.2g} if weights were "
                        "merely rounded (roots of mean squares, on images of the training)",
                        found.output_error, found.output_error_of_rounded));
    }

private:
    const compiled_network& code_;
    const compiled_eight_bit* bytes_;
    any_model model_;
};

class network_method final : public method {
public:
    network_method(std::string_view network, const compiled_network& code, std::string_view type,
                   std::optional<tactnet::published_training> training,
                   std::unique_ptr<compiled_eight_bit> bytes)
        : method(network, code.input.rows, code.input.columns, code.outputs, training),
          type_(type),
          code_(code),
          bytes_(std::move(bytes)) {}

    bool is_network() const override { return true; }
    std::string declaration(std::size_t classes) const override {
        return fmt::format("{}<tactnet::shape{{{}, {}}}, {}>", type_, rows, columns, classes);
    }
    std::optional<pretrained_file> pretrained() const override {
        constexpr std::size_t arrays_of_photograph = 2; // in front, which are no weights
        for (const photograph_network& n : photograph_networks)
            if (name == std::string(n.name) + "-nn")
                return pretrained_file{n, code_.describe().at(arrays_of_photograph).name,
                                       code_.costs.parameter_bytes};
        return std::nullopt;
    }
    std::shared_ptr<pretrained_weights> open_pretrained(const std::filesystem::path& path) const override {
        auto file = tactnet::safetensors_source::open(path);
        const auto form = tactnet::stored_photograph_preprocessing(file);
        auto weights = std::make_shared<begun_weights>();
        weights->arrays = tactnet::pretrained_trunk(file, code_.arrays(), form);
        return weights;
    }
    tactnet::recipe default_recipe() const override {
        if (pretrained() && published)
            return tactnet::recipe::fine_tuning(*published);
        tactnet::recipe r = method::default_recipe();
        if (code_.needs_counts)
            r.input = tactnet::input_rule::scale;
        return r;
    }
    tactnet::file_metadata parts() const override {
        if (type_.starts_with("tactnet::"))
            return {};
        fingerprint print;
        print.add(code_.type);
        return {{"type", print.text()}};
    }
    method_costs costs(std::size_t classes) const override { return code_.costs_for(classes); }
    bool augment_full_resolution(const tactnet::shape& taken) const override {
        return code_.variation_of(taken) != nullptr;
    }
    bool has_eight_bit_form() const override { return bytes_ != nullptr; }
    std::size_t eight_bit_bytes(std::size_t classes) const override {
        const auto layout = bytes_->layout();
        std::size_t sum = 0;
        tactnet::detail::for_each_folded(
            layout, tactnet::detail::arrays_of(layout, classes),
            [&](const auto& array, const auto& in_file, std::size_t) {
                sum += in_file.size * (array.kind == tactnet::folded_kind::weights ? 1 : sizeof(float));
            });
        return sum;
    }
    frame_work make_work(std::size_t bits) const override {
        any_model model{code_.make(), std::vector<float>(code_.pixels()), 1, {}, 1, {}, {}};
        draw_arrays(*model.network);
        std::shared_ptr<any_deployed> deployed =
            bits == 8
                ? bytes_->deploy(bytes_->calibrate(model, made_up_touches(4, image())).folded, {}, 1, {}, {})
                : code_.deploy(model);
        return
            [deployed = std::move(deployed), size = image(), outputs = code_.outputs,
             frames = std::vector<std::uint8_t>(), logits = std::vector<float>()](std::size_t count) mutable {
                if (frames.size() != count * size.area()) {
                    frames = made_up_touches(count, size);
                    logits.resize(count * outputs);
                }
                tactnet::thread_pool alone;
                if (!deployed->infer(alone, frames, logits))
                    throw std::runtime_error("expected finite logits of the frames that are timed");
            };
    }
    tactnet::augmentation_choice choose(const tactnet::recipe& recipe, const image_data& data,
                                        std::span<const std::size_t> training, std::uint64_t seed,
                                        tactnet::thread_pool& threads, bool trials,
                                        const tactnet::fixed_augmentation& fixed,
                                        const tactnet::search_stop& stop,
                                        tactnet::trial_scores* known) const override {
        tactnet::labelled_images varied = data.view();
        varied.taken.vary = code_.variation_of(varied.taken.taken);
        return tactnet::choose_augmentation(*code_.make(), recipe, varied, training, data.groups, seed,
                                            threads, data.images.classes, stop, trials ? 220 : 0, fixed,
                                            known);
    }
    std::unique_ptr<training_run> train(const tactnet::recipe& recipe, const tactnet::labelled_images& images,
                                        tactnet::data_split split, std::uint64_t seed,
                                        tactnet::thread_pool& threads,
                                        const std::shared_ptr<pretrained_weights>& from) const override {
        tactnet::labelled_images varied = images;
        varied.taken.vary = code_.variation_of(images.taken.taken);
        auto training = std::make_unique<epoch_training>(
            code_.make(), recipe, varied, std::move(split), seed, threads, [this](any_model best) {
                return std::make_unique<own_trained_network>(code_, bytes_.get(), std::move(best));
            });
        if (from)
            training->loop().start_from_trunk(dynamic_cast<const begun_weights&>(*from).arrays);
        return training;
    }
    std::unique_ptr<trained_method> load(const weight_file& file,
                                         std::optional<double> epsilon) const override {
        if (!tactnet::describe_model(file.arrays).bits) {
            any_model model = load_model(code_, file.arrays, code_.input, epsilon);
            tactnet::check_selftest(
                file.arrays, code_.input, model.classes.size(),
                [&](std::span<const std::uint8_t> images) { return logits_of(model, images); });
            return std::make_unique<own_trained_network>(code_, bytes_.get(), std::move(model));
        }
        if (!bytes_)
            refuse("{}: metadata 'bits': expected weights in single precision, or a network whose form in 8 "
                   "bits was compiled in (chosen when building, by TACTNET_PROGRAM_EIGHT_BIT), found '8', "
                   "of {} {}",
                   file.arrays.file(), name, size());
        if (epsilon)
            refuse(
                "--epsilon: expected weights in single precision, found 8 bits, into which batch norms are "
                "folded");
        tactnet::stored_deployed stored = tactnet::read_deployed(file.arrays, bytes_->layout());
        auto network = std::make_unique<eight_bit_network>(code_, *bytes_, std::move(stored.folded),
                                                           std::move(stored.classes), stored.temperature,
                                                           stored.function, std::move(stored.reflections));
        network->check_selftest(file.arrays);
        return network;
    }

private:
    tactnet::extent2d image() const { return {rows, columns}; }

    std::string type_;
    compiled_network code_;
    std::unique_ptr<compiled_eight_bit> bytes_;
};

} // namespace

std::unique_ptr<method> make_network_method(std::string_view name, const compiled_network& code,
                                            std::string_view type,
                                            std::optional<tactnet::published_training> published,
                                            std::unique_ptr<compiled_eight_bit> bytes) {
    return std::make_unique<network_method>(name, code, type, published, std::move(bytes));
}
