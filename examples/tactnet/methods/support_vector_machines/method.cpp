// Support vector machines as methods: on pixels, on histograms of SURF words as in the paper's baseline,
// and on features of a network that was trained on photographs: the paper's SqueezeNet-SVM, AlexNet-SVM,
// ResNet50-SVM and VGG16-SVM, and what does better than these.

#include "methods/description.hpp"
#include "methods/support_vector_machines/machine.hpp"
#include "methods/trunks/features.hpp"

#include <tactnet/features/bag_of_words.hpp>
#include <tactnet/runtime/random.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <limits>

namespace {

/// Which machine, and on which features: pixels by a scale, SURF words where that is 0, or those of a trunk.
struct svm_recipe {
    std::string_view name;
    svm_options options;
    float pixel_scale = 0;
    std::string_view trunk{};
    bool pooled = false;
};

const std::vector<svm_recipe>& svm_recipes() {
    constexpr bool pooled = true;
    // The paper's methods take all values of a layer, a machine for each class, and the cost that belongs to
    // a regularisation of one divided by the number of images.
    static const std::vector<svm_recipe> all{
        {"svm-linear", linear_options{.cost = 1}, 1.0f / 255},
        {"svm-rbf", rbf_options{.cost = 10}, 1},
        {"surf-svm", linear_options{.cost = tactnet::surf_settings{}.cost}},
        {"squeezenet-svm", product_options{.cost = 1}, 0, "squeezenet"},
        {"squeezenet-pooled-svm", pair_options{.cost = 1, .standardise = true}, 0, "squeezenet", pooled},
        {"squeezenet-pooled-rbf",
         rbf_options{.kernel = {.gamma = 0.03 / 1024}, .cost = 100, .standardise = true}, 0, "squeezenet",
         pooled},
        {"alexnet-svm", product_options{.cost = 1}, 0, "alexnet"},
        {"resnet50-svm", product_options{.cost = 1}, 0, "resnet50"},
        {"vgg16-svm", product_options{.cost = 1}, 0, "vgg16"},
    };
    return all;
}

/// The counts of an image, multiplied by a scale.
class pixel_features final : public image_features {
public:
    pixel_features(std::size_t pixels, float scale) : pixels_(pixels), scale_(scale) {}

    std::size_t size() const override { return pixels_; }
    tactnet::file_metadata form() const override {
        return {{"features", "pixels"}, {"input", "scale"}, {"input_scale", fmt::to_string(scale_)}};
    }
    double rounding() const override { return 1e-3; }
    std::vector<float> rows(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen,
                            tactnet::thread_pool&) const override {
        std::vector<float> result;
        for (const std::size_t image : chosen)
            for (const std::uint8_t count : images.subspan(image * pixels_, pixels_))
                result.push_back(static_cast<float>(count) * scale_);
        return result;
    }

private:
    std::size_t pixels_;
    float scale_;
};

/// A support vector machine with its features.
class trained_svm final : public trained_method {
public:
    trained_svm(tactnet::extent2d image, std::shared_ptr<const image_features> features,
                support_vector_machine own, std::vector<std::string> classes)
        : image_(image), features_(std::move(features)), own_(std::move(own)), classes_(std::move(classes)) {}

    const std::vector<std::string>& classes() const override { return classes_; }
    tactnet::evaluation evaluate(const tactnet::labelled_images& images, std::span<const std::size_t> chosen,
                                 tactnet::thread_pool& threads,
                                 const tactnet::test_time_augmentation&) const override {
        tactnet::evaluation result{
            std::numeric_limits<double>::quiet_NaN(), tactnet::confusion_matrix(images.classes), {}, {}};
        for (const scored_class& found : recognise_chosen(images.pixels, chosen, threads)) {
            result.confusion.add(images.labels[chosen[result.recognised.size()]], found.label);
            result.recognised.push_back(found.label);
        }
        return result;
    }
    std::vector<scored_class> recognise(std::span<const std::uint8_t> images,
                                        tactnet::thread_pool& threads) const override {
        return recognise_chosen(images, all_of(images), threads);
    }
    void save(const std::filesystem::path& path, const tactnet::file_metadata& metadata,
              std::span<const std::uint8_t> selftest) const override {
        tactnet::safetensors_writer writer;
        writer.metadata = metadata;
        writer.metadata["classes"] = nlohmann::json(classes_).dump();
        features_->save(writer);
        own_.add_to(writer);
        if (!selftest.empty()) {
            tactnet::thread_pool alone;
            const label_list all = all_of(selftest);
            const std::vector<double> values = values_of(selftest, all, alone);
            writer.add("selftest.input", {all.size(), image_.rows, image_.columns}, selftest);
            writer.add("selftest.values", {all.size(), values.size() / all.size()},
                       std::span<const double>(values));
        }
        writer.write(path);
    }
    /// Throws tactnet::file_error when images in the file do not give their values.
    void check_selftest(const tactnet::safetensors& file) const {
        if (!file.contains("selftest.input") && !file.contains("selftest.values"))
            return;
        const std::vector<std::uint8_t> images = file.values<std::uint8_t>("selftest.input");
        const label_list all = all_of(images);
        file.require_extents("selftest.input", std::vector{all.size(), image_.rows, image_.columns});
        tactnet::thread_pool alone;
        const std::vector<double> found = values_of(images, all, alone),
                                  expected = file.values<double>("selftest.values");
        const std::size_t each = all.empty() ? 0 : found.size() / all.size();
        file.require_extents("selftest.values", std::vector{all.size(), each});
        double largest = 0;
        for (const double value : expected)
            largest = std::max(largest, std::abs(value));
        for (std::size_t i = 0; i < expected.size(); ++i)
            if (!(std::abs(found[i] - expected[i]) <= features_->rounding() * largest))
                throw tactnet::file_error(file.file(),
                                          fmt::format("self-test, image {}, machine {}", i / each, i % each),
                                          fmt::format("the value {}", expected[i]), fmt::to_string(found[i]));
    }

private:
    label_list all_of(std::span<const std::uint8_t> images) const {
        return tactnet::all_samples(images.size() / (image_.rows * image_.columns));
    }
    std::vector<double> values_of(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen,
                                  tactnet::thread_pool& threads) const {
        const std::vector<float> rows = features_->rows(images, chosen, threads);
        return own_.values(feature_list(rows, features_->size()), threads);
    }
    std::vector<scored_class> recognise_chosen(std::span<const std::uint8_t> images,
                                               std::span<const std::size_t> chosen,
                                               tactnet::thread_pool& threads) const {
        // Some at a time: what is found of all of them can exceed the memory.
        const std::size_t each = own_.machines(),
                          bytes = each * sizeof(double) + features_->size() * sizeof(float),
                          most = std::max<std::size_t>(1, (std::size_t{1} << 26U) / bytes);
        std::vector<scored_class> result;
        for (; !chosen.empty(); chosen = chosen.subspan(std::min(most, chosen.size()))) {
            const auto part = chosen.first(std::min(most, chosen.size()));
            const std::vector<double> values = values_of(images, part, threads);
            for (std::size_t i = 0; i < part.size(); ++i)
                result.push_back(own_.decide(std::span(values).subspan(i * each, each)));
        }
        return result;
    }

    tactnet::extent2d image_;
    std::shared_ptr<const image_features> features_;
    support_vector_machine own_;
    std::vector<std::string> classes_;
};

/// The training of a support vector machine: a single step.
class svm_training final : public training_run {
public:
    svm_training(tactnet::extent2d image, std::shared_ptr<image_features> features,
                 const svm_options& options, const tactnet::labelled_images& images,
                 tactnet::data_split split, tactnet::thread_pool& threads)
        : image_(image),
          features_(std::move(features)),
          options_(options),
          images_(images),
          split_(std::move(split)),
          threads_(threads) {}

    bool finished() const override { return own_.has_value(); }
    void advance() override {
        features_->fit(images_.pixels, split_.training, threads_);
        const std::vector<float> rows = features_->rows(images_.pixels, split_.training, threads_);
        label_list labels;
        for (const std::size_t image : split_.training)
            labels.push_back(images_.labels[image]);
        own_ =
            support_vector_machine::train(options_, feature_list(rows, features_->size()), labels, threads_);
    }
    const tactnet::data_split& split() const override { return split_; }
    std::unique_ptr<trained_method> best(const std::vector<std::string>& classes) const override {
        return std::make_unique<trained_svm>(image_, features_, *own_, classes);
    }

private:
    tactnet::extent2d image_;
    std::shared_ptr<image_features> features_;
    const svm_options& options_;
    std::optional<support_vector_machine> own_;
    tactnet::labelled_images images_;
    tactnet::data_split split_;
    tactnet::thread_pool& threads_;
};

/// As many images as the paper trains with.
constexpr std::size_t paper_classes = 22, paper_images_of_class = 32;

class svm_method final : public method {
public:
    /// `trunk` may be null, for a recipe without one.
    svm_method(const svm_recipe& recipe, tactnet::extent2d image, make_features* surf,
               std::shared_ptr<const compiled_trunk> trunk)
        : method(recipe.name, image.rows, image.columns, std::numeric_limits<std::size_t>::max()),
          recipe_(recipe),
          surf_(surf),
          finder_{std::move(trunk), recipe.pooled, image} {}

    bool is_network() const override { return false; }
    bool keeps_features() const override { return finder_.trunk != nullptr; }
    std::optional<pretrained_file> pretrained() const override {
        return finder_.trunk ? std::optional(finder_.file()) : std::nullopt;
    }
    std::shared_ptr<pretrained_weights> open_pretrained(const std::filesystem::path& path) const override {
        return trunk_features::pretrained(finder_, path);
    }
    tactnet::file_metadata parts() const override {
        const auto features = make();
        tactnet::file_metadata all = describe(recipe_.options);
        all.merge(features->form());
        all.merge(features->fit_settings());
        return all;
    }
    /// Costs of a machine that was trained on the paper's number of images, at the worst all support vectors.
    method_costs costs(std::size_t classes) const override {
        const auto features = make();
        const std::size_t inputs = features->size();
        const bool has_kernel = std::holds_alternative<pair_options>(recipe_.options) ||
                                std::holds_alternative<rbf_options>(recipe_.options);
        const std::size_t products = classes * inputs * (has_kernel ? paper_images_of_class : 1);
        method_costs result = features->costs();
        result.parameters += products + (has_kernel ? 0 : classes);
        result.multiply_adds += products;
        result.multiply_adds_on_pixels += products;
        result.parameter_bytes = result.parameters * sizeof(float);
        result.activation_bytes = std::max(result.activation_bytes, inputs * sizeof(float));
        return result;
    }
    frame_work make_work(std::size_t) const override {
        const label_list all = tactnet::all_samples(paper_classes * paper_images_of_class);
        label_list labels;
        for (const std::size_t i : all)
            labels.push_back(i % paper_classes);
        tactnet::thread_pool alone;
        if (finder_.trunk) { // on random numbers, most of which become support vectors
            const std::size_t size = finder_.size();
            tactnet::random_stream random(1, tactnet::random_purposes::order);
            std::vector<float> numbers(all.size() * size);
            std::ranges::generate(numbers, [&] { return static_cast<float>(random.uniform()); });
            const auto machine =
                support_vector_machine::train(recipe_.options, feature_list(numbers, size), labels, alone);
            return finder_.work([size, machine](std::span<const float> features) {
                tactnet::thread_pool threads;
                static_cast<void>(machine.values(feature_list(features, size), threads));
            });
        }
        // The time of a machine depends on what it learnt.
        std::vector<std::uint8_t> pixels = made_up_touches(all.size(), finder_.image);
        svm_training run(finder_.image, make(), recipe_.options, {pixels, labels, paper_classes},
                         {all, {}, {}}, alone);
        run.advance();
        return [trained = std::shared_ptr(run.best({})), pixels = std::move(pixels),
                each = finder_.image.area()](std::size_t frames) {
            tactnet::thread_pool threads;
            static_cast<void>(trained->recognise(std::span(pixels).first(frames * each), threads));
        };
    }
    std::unique_ptr<training_run> train(const tactnet::recipe&, const tactnet::labelled_images& images,
                                        tactnet::data_split split, std::uint64_t,
                                        tactnet::thread_pool& threads,
                                        const std::shared_ptr<pretrained_weights>& from) const override {
        return std::make_unique<svm_training>(finder_.image,
                                              from ? std::dynamic_pointer_cast<trunk_features>(from) : make(),
                                              recipe_.options, images, std::move(split), threads);
    }
    std::unique_ptr<trained_method> load(const weight_file& from, std::optional<double>) const override {
        const tactnet::safetensors& file = from.arrays;
        const tactnet::model_description says = tactnet::describe_model(file);
        support_vector_machine own = support_vector_machine::load(recipe_.options, file);
        std::shared_ptr<image_features> features = make();
        require_metadata(file, {{"rows", fmt::to_string(rows)}, {"columns", fmt::to_string(columns)}});
        require_metadata(file, features->form());
        features->load(from);
        if (own.features != features->size())
            throw tactnet::file_error(file.file(), "", fmt::format("{} features", features->size()),
                                      fmt::to_string(own.features));
        if (own.labels.back() >= says.classes.size()) // they rise
            throw tactnet::file_error(file.file(), "tensor 'labels'",
                                      fmt::format("labels of {} classes", says.classes.size()),
                                      fmt::to_string(own.labels.back()));
        auto trained =
            std::make_unique<trained_svm>(finder_.image, std::move(features), std::move(own), says.classes);
        trained->check_selftest(file);
        return trained;
    }

private:
    std::shared_ptr<image_features> make() const {
        if (finder_.trunk)
            return std::make_shared<trunk_features>(finder_);
        if (recipe_.pixel_scale > 0)
            return std::make_shared<pixel_features>(finder_.image.area(), recipe_.pixel_scale);
        return surf_();
    }

    const svm_recipe& recipe_;
    make_features* surf_;
    feature_finder finder_; ///< without a trunk, just the size of images
};

} // namespace

void add_methods_on_features(std::vector<std::unique_ptr<method>>& methods, tactnet::extent2d image,
                             make_features* surf,
                             const std::vector<std::shared_ptr<const compiled_trunk>>& trunks) {
    for (const svm_recipe& recipe : svm_recipes()) {
        if (recipe.trunk.empty())
            methods.push_back(std::make_unique<svm_method>(recipe, image, surf, nullptr));
        for (const auto& trunk : trunks)
            if (trunk->network.name == recipe.trunk)
                methods.push_back(std::make_unique<svm_method>(recipe, image, surf, trunk));
    }
}
