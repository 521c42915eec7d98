#include "methods/support_vector_machines/trunk_svm.hpp"

#include "methods/support_vector_machines/svm_method.hpp"
#include "methods/support_vector_machines/trained.hpp"
#include "methods/trunks/features.hpp"

#include <tactnet/runtime/random.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

namespace {

struct trunk_recipe {
    std::string_view trunk;
    svm_recipe svm;
    trunk_features_form features;
};

/// The paper's: all values of a layer, a machine for each class, and the cost that belongs to a
/// regularisation of one divided by the number of images.
trunk_recipe published(std::string_view trunk, std::string_view name) {
    return {trunk, {name, product_options{.cost = 1}}, {}};
}

const std::vector<trunk_recipe>& trunk_recipes() {
    static const std::vector<trunk_recipe> all{
        published("squeezenet", "squeezenet-svm"),
        {"squeezenet",
         {"squeezenet-pooled-svm", pair_options{.cost = 1, .standardise = true}},
         {trunk_pooling::pooled, true}},
        {"squeezenet",
         {"squeezenet-pooled-rbf",
          rbf_options{.kernel = {.gamma = 0.03 / 1024}, .cost = 100, .standardise = true}},
         {trunk_pooling::pooled, true}},
        published("alexnet", "alexnet-svm"),
        published("resnet50", "resnet50-svm"),
        published("vgg16", "vgg16-svm"),
    };
    return all;
}

/// A trunk in front of a support vector machine. Without weights it only tells what it costs.
class trunk_image_features final : public image_features {
public:
    trunk_image_features(std::shared_ptr<const compiled_trunk> trunk, trunk_features_form form,
                         tactnet::extent2d image, std::shared_ptr<const trunk_features> own = nullptr)
        : trunk_(std::move(trunk)), form_(form), image_(image), own_(std::move(own)) {}

    std::size_t size() const override { return form_.size(trunk_->map); }
    std::size_t multiply_adds() const override { return form_.views() * trunk_->costs.multiply_adds; }
    std::size_t parameters() const override { return trunk_->costs.parameters; }
    tactnet::file_metadata form() const override { return describe_features(*trunk_, form_); }
    tactnet::file_metadata fit_settings() const override { return {}; }
    double rounding() const override { return feature_rounding; }
    void fit(std::span<const std::uint8_t>, std::span<const std::size_t>, tactnet::thread_pool&) override {}
    std::vector<float> rows(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen,
                            tactnet::thread_pool& threads) const override {
        return own_->rows(images, chosen, threads);
    }
    void save(tactnet::safetensors_writer& writer) const override { own_->add_to(writer); }
    void load(const weight_file& file) override { own_ = stored_features(trunk_, form_, image_, file); }

private:
    std::shared_ptr<const compiled_trunk> trunk_;
    trunk_features_form form_;
    tactnet::extent2d image_;
    std::shared_ptr<const trunk_features> own_;
};

/// Numbers as features are: none below zero.
std::vector<float> made_up_rows(std::size_t rows, std::size_t size) {
    tactnet::random_stream random(1, tactnet::random_purposes::order);
    std::vector<float> values(rows * size);
    for (float& value : values)
        value = static_cast<float>(random.uniform());
    return values;
}

constexpr std::size_t timed_classes = 22, timed_images_of_class = 32; // as the paper

/// Machines of the size that they have at the most: their time depends on nothing else.
support_vector_machine made_up_machine(const linear_options&, std::size_t features) {
    tactnet::linear_machine_parameters parts;
    parts.features = features;
    parts.labels = tactnet::all_samples(timed_classes);
    parts.weights = made_up_rows(timed_classes, features);
    parts.offsets.resize(timed_classes);
    return linear_machine(std::move(parts));
}
support_vector_machine made_up_machine(const product_options&, std::size_t features) {
    return made_up_machine(linear_options{}, features);
}
template <class Kernel>
support_vector_machine made_up_machine(const tactnet::kernel_training_options<Kernel>& options,
                                       std::size_t features) {
    constexpr std::size_t vectors = timed_classes * timed_images_of_class;
    tactnet::kernel_machine_parameters<Kernel> parts;
    parts.kernel = options.kernel;
    parts.scheme = options.scheme;
    parts.features = features;
    parts.labels = tactnet::all_samples(timed_classes);
    parts.support_counts.assign(timed_classes, timed_images_of_class);
    parts.support_vectors = made_up_rows(vectors, features);
    parts.coefficients.assign(vectors * parts.coefficients_each(), 0.5);
    parts.offsets.resize(tactnet::machine_count(timed_classes, options.scheme));
    return tactnet::kernel_machine<Kernel>(std::move(parts));
}

class trunk_svm_method final : public svm_method {
public:
    trunk_svm_method(const trunk_recipe& recipe, std::size_t rows_, std::size_t columns_,
                     std::shared_ptr<const compiled_trunk> trunk)
        : svm_method(recipe.svm, rows_, columns_,
                     [=, form = recipe.features] {
                         return std::make_unique<trunk_image_features>(trunk, form,
                                                                       tactnet::extent2d{rows_, columns_});
                     }),
          form_(recipe.features),
          trunk_(std::move(trunk)) {}

    std::optional<pretrained_file> pretrained() const override { return pretrained_file_of(*trunk_); }
    std::size_t learnable(std::size_t classes) const override {
        return costs(classes).parameters - trunk_->costs.parameters;
    }
    bool keeps_features() const override { return true; }
    std::shared_ptr<pretrained_weights> open_pretrained(const std::filesystem::path& path) const override {
        return open_trunk(trunk_, form_, {rows, columns}, path);
    }
    std::unique_ptr<training_run> train(const tactnet::recipe&, const tactnet::labelled_images& images,
                                        tactnet::data_split split, std::uint64_t,
                                        tactnet::thread_pool& threads,
                                        const std::shared_ptr<pretrained_weights>& from) const override {
        return train_on(std::make_unique<trunk_image_features>(
                            trunk_, form_, tactnet::extent2d{rows, columns}, features_of(from)),
                        images, std::move(split), threads);
    }
    method_costs costs(std::size_t classes) const override {
        method_costs result = svm_method::costs(classes);
        result.multiply_adds_on_pixels -=
            form_.views() * (trunk_->costs.multiply_adds - trunk_->costs.multiply_adds_on_pixels);
        result.activation_bytes = std::max(result.activation_bytes, trunk_->costs.activation_bytes);
        return result;
    }
    frame_work make_work(std::size_t) const override {
        const std::size_t size = form_.size(trunk_->map);
        return work_behind(
            trunk_, form_, {rows, columns},
            [size, machine = std::visit([&](const auto& options) { return made_up_machine(options, size); },
                                        recipe().options)](std::span<const float> features) {
                tactnet::thread_pool alone;
                static_cast<void>(machine.values(feature_list(features, size), alone));
            });
    }

private:
    trunk_features_form form_;
    std::shared_ptr<const compiled_trunk> trunk_;
};

} // namespace

std::vector<std::unique_ptr<method>>
make_trunk_svm_methods(std::size_t rows, std::size_t columns,
                       const std::vector<std::shared_ptr<const compiled_trunk>>& trunks) {
    std::vector<std::unique_ptr<method>> list;
    for (const trunk_recipe& recipe : trunk_recipes())
        for (const auto& trunk : trunks)
            if (trunk->names.network.name == recipe.trunk)
                list.push_back(std::make_unique<trunk_svm_method>(recipe, rows, columns, trunk));
    return list;
}
