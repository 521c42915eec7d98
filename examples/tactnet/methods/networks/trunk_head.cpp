#include "methods/networks/trunk_head.hpp"

#include "methods/description.hpp"
#include "methods/in_parts.hpp"
#include "methods/networks/any_model.hpp"
#include "methods/networks/looped_training.hpp"
#include "methods/trunks/features.hpp"

#include <tactnet/io/model_file.hpp>
#include <tactnet/svm/feature_rows.hpp>

#include <algorithm>
#include <stdexcept>
#include <utility>

namespace {

tactnet::stored_arrays stored_arrays_of(const compiled_head& head, const tactnet::trainable& network) {
    return tactnet::stored_arrays_of(network.describe(), head.outputs);
}

/// A frozen trunk with the head that was trained behind it.
class trained_trunk_head final : public trained_method {
public:
    trained_trunk_head(const compiled_head& head, tactnet::extent2d image,
                       std::shared_ptr<const trunk_features> features, any_model model)
        : head_(head), image_(image), features_(std::move(features)), model_(std::move(model)) {}

    const std::vector<std::string>& classes() const override { return model_.classes; }
    tactnet::evaluation evaluate(const tactnet::labelled_images& images, std::span<const std::size_t> chosen,
                                 tactnet::thread_pool& threads) const override {
        tactnet::evaluation result{0, tactnet::confusion_matrix(images.classes), {}};
        in_parts(
            chosen.size(), model_.mean.size() * sizeof(float), [&](std::size_t first, std::size_t count) {
                const auto some = chosen.subspan(first, count);
                const std::vector<float> rows = features_->rows(images.pixels, some, threads);
                std::vector<std::size_t> labels;
                for (const std::size_t image : some)
                    labels.push_back(images.labels[image]);
                const tactnet::evaluation part =
                    tactnet::evaluate(*model_.network, model_.mean, model_.scale,
                                      tactnet::labelled_features{rows, labels, images.classes},
                                      tactnet::all_samples(count), threads);
                result.loss += part.loss * static_cast<double>(count) / static_cast<double>(chosen.size());
                for (std::size_t i = 0; i < count; ++i) {
                    result.recognised.push_back(part.recognised[i]);
                    result.confusion.add(labels[i], part.recognised[i]);
                }
            });
        return result;
    }
    std::vector<scored_class> recognise(std::span<const std::uint8_t> images,
                                        tactnet::thread_pool& threads) const override {
        std::vector<scored_class> result;
        in_parts(tactnet::detail::count_images(images.size(), image_.area()),
                 model_.mean.size() * sizeof(float), [&](std::size_t first, std::size_t count) {
                     const auto some = images.subspan(first * image_.area(), count * image_.area());
                     for (const scored_class& found :
                          classes_of_rows(logits(some, threads), classes().size(), classes().size()))
                         result.push_back(found);
                 });
        return result;
    }
    void save(const std::filesystem::path& path, const tactnet::file_metadata& metadata,
              std::span<const std::uint8_t> selftest) const override {
        const auto parts =
            parts_of(model_, {image_.rows, image_.columns}, stored_arrays_of(head_, *model_.network));
        tactnet::safetensors_writer writer;
        writer.metadata = metadata;
        tactnet::add_model(writer, parts, selftest,
                           [&](std::span<const std::uint8_t> images) { return logits(images); });
        features_->add_to(writer);
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

    const compiled_head& head_;
    tactnet::extent2d image_;
    std::shared_ptr<const trunk_features> features_;
    any_model model_;
};

/// What a training learns from. A base, so that it is there before the loop that views it, and after.
struct kept_rows {
    std::shared_ptr<const std::vector<float>> rows;
};

class trunk_head_training final : private kept_rows, public looped_training {
public:
    trunk_head_training(const compiled_head& head, tactnet::extent2d image,
                        std::shared_ptr<const trunk_features> features, const tactnet::recipe& recipe,
                        const tactnet::labelled_images& images, tactnet::data_split split, std::uint64_t seed,
                        tactnet::thread_pool& threads)
        : kept_rows{features->all_rows(images.pixels, threads)},
          looped_training(head.make(), recipe,
                          tactnet::labelled_features{*rows, images.labels, images.classes}, std::move(split),
                          seed, threads),
          head_(head),
          image_(image),
          features_(std::move(features)) {}

    void start_from(const trained_method&) override {
        throw std::logic_error("the head of a frozen trunk begins by chance");
    }
    std::unique_ptr<trained_method> best(const std::vector<std::string>& classes) const override {
        return std::make_unique<trained_trunk_head>(head_, image_, features_, best_model(classes));
    }

private:
    const compiled_head& head_;
    tactnet::extent2d image_;
    std::shared_ptr<const trunk_features> features_;
};

class trunk_head_method final : public method {
public:
    trunk_head_method(std::size_t rows_, std::size_t columns_, std::shared_ptr<const compiled_trunk> trunk)
        : method(trunk->head.method, rows_, columns_, trunk->head.outputs), trunk_(std::move(trunk)) {}

    bool is_network() const override { return true; }
    std::string_view kind() const override { return "head of a frozen trunk"; }
    bool keeps_features() const override { return true; }
    std::optional<pretrained_file> pretrained() const override { return pretrained_file_of(*trunk_); }
    std::shared_ptr<pretrained_weights> open_pretrained(const std::filesystem::path& path) const override {
        return open_trunk(trunk_, head().features, image(), path);
    }
    tactnet::recipe default_recipe() const override { return tactnet::recipe::on_features(); }
    tactnet::file_metadata parts() const override { return describe_features(*trunk_, head().features); }
    method_costs costs(std::size_t classes) const override {
        const method_costs own = costs_for(head().costs, head().costs_of_one, head().outputs, classes);
        const std::size_t views = head().features.views();
        return {own.parameters + trunk_->costs.parameters,
                own.multiply_adds + views * trunk_->costs.multiply_adds,
                own.multiply_adds_on_pixels + views * trunk_->costs.multiply_adds_on_pixels,
                own.parameter_bytes + trunk_->costs.parameter_bytes,
                std::max(own.activation_bytes, trunk_->costs.activation_bytes)};
    }
    std::size_t learnable(std::size_t classes) const override {
        return costs(classes).parameters - trunk_->costs.parameters;
    }
    frame_work make_work(std::size_t) const override {
        std::shared_ptr<tactnet::trainable> own = head().make();
        draw_arrays(*own);
        std::shared_ptr<tactnet::trainable::workspace> space = own->make_workspace();
        tactnet::thread_pool threads;
        own->prepare(threads, *space);
        const std::size_t size = head().features.size(trunk_->map);
        return work_behind(
            trunk_, head().features, image(),
            [own, space, size, in = tactnet::sample_batch(size),
             out = tactnet::sample_batch(own->outputs())](std::span<const float> features) mutable {
                const std::size_t count = features.size() / size;
                in.resize(count), out.resize(count);
                for (std::size_t i = 0; i < count; ++i)
                    in.set(i, features.subspan(i * size, size));
                tactnet::thread_pool alone;
                own->logits(in, out, alone, *space);
            });
    }
    std::unique_ptr<training_run> train(const tactnet::recipe& recipe, const tactnet::labelled_images& images,
                                        tactnet::data_split split, std::uint64_t seed,
                                        tactnet::thread_pool& threads,
                                        const std::shared_ptr<pretrained_weights>& from) const override {
        return std::make_unique<trunk_head_training>(head(), image(), features_of(from), recipe, images,
                                                     std::move(split), seed, threads);
    }
    std::unique_ptr<trained_method> load(const weight_file& file,
                                         std::optional<double> epsilon) const override {
        require_metadata(file.arrays, describe_features(*trunk_, head().features));
        any_model model{head().make(), {}, 1, {}};
        const auto arrays = stored_arrays_of(head(), *model.network);
        take(model, tactnet::read_model(file.arrays, {rows, columns}, arrays, epsilon));
        auto trained = std::make_unique<trained_trunk_head>(
            head(), image(), stored_features(trunk_, head().features, image(), file), std::move(model));
        trained->check_selftest(file.arrays);
        return trained;
    }

private:
    const compiled_head& head() const { return trunk_->head; }
    tactnet::extent2d image() const { return {rows, columns}; }

    std::shared_ptr<const compiled_trunk> trunk_;
};

} // namespace

std::vector<std::unique_ptr<method>>
make_trunk_head_methods(std::size_t rows, std::size_t columns,
                        const std::vector<std::shared_ptr<const compiled_trunk>>& trunks) {
    std::vector<std::unique_ptr<method>> list;
    for (const auto& trunk : trunks)
        list.push_back(std::make_unique<trunk_head_method>(rows, columns, trunk));
    return list;
}
