// Heads that are trained on a frozen trunk, as methods.

#include "methods/description.hpp"
#include "methods/trunks/features.hpp"

#include <tactnet/svm/feature_rows.hpp>

#include <utility>

namespace {

/// A frozen trunk with the head that was trained on it.
class trained_trunk_head final : public trained_method {
public:
    trained_trunk_head(const compiled_network& head, tactnet::extent2d image,
                       std::shared_ptr<trunk_features> features, any_model model)
        : head_(head), image_(image), features_(std::move(features)), model_(std::move(model)) {}

    const std::vector<std::string>& classes() const override { return model_.classes; }
    tactnet::evaluation evaluate(const tactnet::labelled_images& images, std::span<const std::size_t> chosen,
                                 tactnet::thread_pool& threads,
                                 tactnet::test_time_augmentation) const override {
        const std::vector<float> rows = features_->rows(images.pixels, chosen, threads);
        std::vector<std::size_t> labels;
        for (const std::size_t image : chosen)
            labels.push_back(images.labels[image]);
        return tactnet::evaluate(*model_.network, model_.mean, model_.scale,
                                 tactnet::labelled_features{rows, labels, images.classes},
                                 tactnet::all_samples(chosen.size()), threads);
    }
    std::vector<scored_class> recognise(std::span<const std::uint8_t> images,
                                        const tactnet::temperature_scaling& scaling,
                                        tactnet::thread_pool& threads) const override {
        return classes_of_rows(logits(images, threads), classes().size(), classes().size(), scaling);
    }
    void save(const std::filesystem::path& path, const tactnet::file_metadata& metadata,
              std::span<const std::uint8_t> selftest) const override {
        const auto parts = parts_of(model_, {image_.rows, image_.columns}, head_.arrays());
        tactnet::safetensors_writer writer;
        writer.metadata = metadata;
        tactnet::add_model(writer, parts, selftest,
                           [&](std::span<const std::uint8_t> images) { return logits(images); });
        features_->save(writer);
        writer.write(path);
    }
    /// Throws tactnet::file_error when images in the file do not give their logits.
    void check_selftest(const tactnet::safetensors& file) const {
        tactnet::check_selftest(
            file, {image_.rows, image_.columns}, classes().size(),
            [&](std::span<const std::uint8_t> images) { return logits(images); },
            static_cast<float>(feature_rounding));
    }

private:
    std::vector<float> logits(std::span<const std::uint8_t> images, tactnet::thread_pool& threads) const {
        const std::size_t count = tactnet::detail::count_images(images.size(), image_.area());
        const std::vector<float> rows = features_->rows(images, tactnet::all_samples(count), threads);
        const std::size_t size = model_.mean.size();
        return logits_of(model_, count, [&](std::size_t i, std::span<float> features) {
            std::ranges::copy(std::span(rows).subspan(i * size, size), features.begin());
        });
    }
    std::vector<float> logits(std::span<const std::uint8_t> images) const {
        tactnet::thread_pool alone;
        return logits(images, alone);
    }

    const compiled_network& head_;
    tactnet::extent2d image_;
    std::shared_ptr<trunk_features> features_;
    any_model model_;
};

class trunk_head_method final : public method {
public:
    trunk_head_method(tactnet::extent2d image, const std::shared_ptr<const compiled_trunk>& trunk)
        : method(trunk->head_method, image.rows, image.columns, trunk->head.outputs),
          finder_{trunk, trunk->head_features_pooled, image} {}

    bool is_network() const override { return true; }
    std::string_view kind() const override { return "head of a frozen trunk"; }
    bool keeps_features() const override { return true; }
    std::optional<pretrained_file> pretrained() const override { return finder_.file(); }
    std::shared_ptr<pretrained_weights> open_pretrained(const std::filesystem::path& path) const override {
        return trunk_features::pretrained(finder_, path);
    }
    tactnet::recipe default_recipe() const override { return tactnet::recipe::on_features(); }
    tactnet::file_metadata parts() const override { return finder_.describe(); }
    method_costs costs(std::size_t classes) const override {
        const method_costs own = head().costs_for(classes), trunk = finder_.costs();
        return {own.parameters + trunk.parameters, own.multiply_adds + trunk.multiply_adds,
                own.multiply_adds_on_pixels + trunk.multiply_adds_on_pixels,
                own.parameter_bytes + trunk.parameter_bytes,
                std::max(own.activation_bytes, trunk.activation_bytes)};
    }
    std::size_t learnable(std::size_t classes) const override { return head().costs_for(classes).parameters; }
    frame_work make_work(std::size_t) const override {
        const std::size_t size = finder_.size();
        const auto model = std::make_shared<any_model>(
            any_model{head().make(), std::vector<float>(size), 1, std::vector<std::string>(capacity)});
        draw_arrays(*model->network);
        return finder_.work([model, size](std::span<const float> found) {
            static_cast<void>(logits_of(*model, found.size() / size, [&](std::size_t i, std::span<float> to) {
                std::ranges::copy(found.subspan(i * size, size), to.begin());
            }));
        });
    }
    std::unique_ptr<training_run> train(const tactnet::recipe& recipe, const tactnet::labelled_images& images,
                                        tactnet::data_split split, std::uint64_t seed,
                                        tactnet::thread_pool& threads,
                                        const std::shared_ptr<pretrained_weights>& from) const override {
        const auto features = std::dynamic_pointer_cast<trunk_features>(from);
        return std::make_unique<epoch_training>(
            head().make(), recipe,
            tactnet::labelled_features{features->all_rows(), images.labels, images.classes}, std::move(split),
            seed, threads, [this, features](any_model best) {
                return std::make_unique<trained_trunk_head>(head(), finder_.image, features, std::move(best));
            });
    }
    std::unique_ptr<trained_method> load(const weight_file& file,
                                         std::optional<double> epsilon) const override {
        require_metadata(file.arrays, finder_.describe());
        any_model model = load_model(head(), file.arrays, {rows, columns}, epsilon);
        auto features = std::make_shared<trunk_features>(finder_);
        features->load(file);
        auto trained = std::make_unique<trained_trunk_head>(head(), finder_.image, std::move(features),
                                                            std::move(model));
        trained->check_selftest(file.arrays);
        return trained;
    }

private:
    const compiled_network& head() const { return finder_.trunk->head; }

    feature_finder finder_;
};

} // namespace

std::vector<std::unique_ptr<method>>
make_trunk_head_methods(tactnet::extent2d image,
                        const std::vector<std::shared_ptr<const compiled_trunk>>& trunks) {
    std::vector<std::unique_ptr<method>> list;
    for (const auto& trunk : trunks)
        list.push_back(std::make_unique<trunk_head_method>(image, trunk));
    return list;
}
