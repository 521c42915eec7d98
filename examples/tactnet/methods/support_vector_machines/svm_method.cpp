#include "methods/support_vector_machines/svm_method.hpp"

#include "methods/description.hpp"
#include "methods/support_vector_machines/trained.hpp"

#include <tactnet/runtime/random.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <variant>

namespace {

/// The training of a support vector machine: a single step.
class svm_training final : public training_run {
public:
    svm_training(tactnet::extent2d image, std::shared_ptr<image_features> features, const svm_recipe& recipe,
                 const tactnet::labelled_images& images, tactnet::data_split split,
                 tactnet::thread_pool& threads)
        : image_(image),
          features_(std::move(features)),
          recipe_(recipe),
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
        own_ = std::visit(
            [&](const auto& options) {
                return train_svm(feature_list(rows, features_->size()), labels, options, threads_);
            },
            recipe_.options);
    }
    const tactnet::data_split& split() const override { return split_; }
    std::unique_ptr<trained_method> best(const std::vector<std::string>& classes) const override {
        return std::make_unique<trained_svm>(image_, features_, *own_, classes);
    }

private:
    tactnet::extent2d image_;
    std::shared_ptr<image_features> features_;
    const svm_recipe& recipe_;
    std::optional<support_vector_machine> own_;
    tactnet::labelled_images images_;
    tactnet::data_split split_;
    tactnet::thread_pool& threads_;
};

} // namespace

svm_method::svm_method(const svm_recipe& recipe, std::size_t rows_, std::size_t columns_,
                       feature_maker features)
    : method(recipe.name, rows_, columns_, std::numeric_limits<std::size_t>::max()),
      recipe_(recipe),
      features_(std::move(features)) {}

tactnet::file_metadata svm_method::parts() const {
    const auto features = features_();
    tactnet::file_metadata text = recipe_.describe();
    text.merge(features->form());
    text.merge(features->fit_settings());
    return text;
}

method_costs svm_method::costs(std::size_t classes) const {
    const auto features = features_();
    const std::size_t inputs = features->size();
    method_costs result;
    if (recipe_.has_weights())
        result.parameters = classes * (inputs + 1), result.multiply_adds = classes * inputs;
    else
        result.parameters = result.multiply_adds = classes * images_of_class * inputs;
    result.parameters += features->parameters();
    result.multiply_adds += features->multiply_adds();
    result.multiply_adds_on_pixels = result.multiply_adds;
    result.parameter_bytes = result.parameters * sizeof(float);
    result.activation_bytes = inputs * sizeof(float);
    return result;
}

frame_work svm_method::make_work(std::size_t) const {
    // Made-up touches, as many as the paper trains with: the time of a machine depends on what it learnt.
    constexpr std::size_t classes = 22, count = classes * images_of_class;
    std::vector<std::uint8_t> pixels;
    label_list labels;
    const label_list all = tactnet::all_samples(count);
    for (std::uint32_t i = 0; i < count; ++i) {
        labels.push_back(i % classes);
        tactnet::random_stream random(1, tactnet::random_purposes::order, i);
        const double row = random.uniform(0, static_cast<double>(rows)),
                     column = random.uniform(0, static_cast<double>(columns)),
                     size = 2 + static_cast<double>(i % classes);
        for (std::size_t y = 0; y < rows; ++y)
            for (std::size_t x = 0; x < columns; ++x) {
                const double dy = static_cast<double>(y) - row, dx = static_cast<double>(x) - column;
                const double pressure = std::max(0.0, 1 - (dy * dy + dx * dx) / (size * size));
                pixels.push_back(static_cast<std::uint8_t>(200 * pressure + random.uniform(0, 8)));
            }
    }
    tactnet::thread_pool alone;
    svm_training run({rows, columns}, features_(), recipe_, {pixels, labels, classes}, {all, {}, {}}, alone);
    run.advance();
    return [trained = std::shared_ptr(run.best({})), pixels](std::size_t frames) {
        tactnet::thread_pool threads;
        const std::size_t each = pixels.size() / count;
        static_cast<void>(trained->recognise(std::span(pixels).first(frames * each), threads));
    };
}

std::unique_ptr<training_run> svm_method::train_on(std::unique_ptr<image_features> features,
                                                   const tactnet::labelled_images& images,
                                                   tactnet::data_split split,
                                                   tactnet::thread_pool& threads) const {
    return std::make_unique<svm_training>(tactnet::extent2d{rows, columns}, std::move(features), recipe_,
                                          images, std::move(split), threads);
}

std::unique_ptr<training_run> svm_method::train(const tactnet::recipe&,
                                                const tactnet::labelled_images& images,
                                                tactnet::data_split split, std::uint64_t,
                                                tactnet::thread_pool& threads,
                                                const std::shared_ptr<pretrained_weights>&) const {
    return train_on(features_(), images, std::move(split), threads);
}

std::unique_ptr<trained_method> svm_method::load(const weight_file& from, std::optional<double>) const {
    const tactnet::safetensors& file = from.arrays;
    const tactnet::model_description says = tactnet::describe_model(file);
    support_vector_machine own =
        std::visit([&](const auto& options) { return load_svm(file, options); }, recipe_.options);
    std::shared_ptr<image_features> features = features_();
    require_metadata(file, {{"rows", fmt::to_string(rows)}, {"columns", fmt::to_string(columns)}});
    require_metadata(file, features->form());
    features->load(from);
    if (own.features() != features->size())
        throw tactnet::file_error(file.file(), "", fmt::format("{} features", features->size()),
                                  fmt::to_string(own.features()));
    if (own.labels().back() >= says.classes.size()) // they rise
        throw tactnet::file_error(file.file(), "tensor 'labels'",
                                  fmt::format("labels of {} classes", says.classes.size()),
                                  fmt::to_string(own.labels().back()));
    auto trained = std::make_unique<trained_svm>(tactnet::extent2d{rows, columns}, std::move(features),
                                                 std::move(own), says.classes);
    trained->check_selftest(file);
    return trained;
}
