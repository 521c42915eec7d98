#include "machines.hpp"

#include "stopwatch.hpp"
#include "usage_error.hpp"

#include <tactnet/kernels/random.hpp>
#include <tactnet/svm.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace {

using label_list = std::vector<std::size_t>;
using feature_list = tactnet::feature_rows<>;

/// The counts of an image as they are, or divided by 255.
class pixel_features final : public image_features {
public:
    pixel_features(std::size_t pixels, float scale) : pixels_(pixels), scale_(scale) {}

    std::size_t size() const override { return pixels_; }
    std::size_t multiply_adds() const override { return 0; }
    std::size_t parameters() const override { return 0; }
    void fit(std::span<const std::uint8_t>, std::span<const std::size_t>, tactnet::thread_pool&) override {}
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

/// A machine that is trained: the label of each row.
using machine = std::function<label_list(feature_list, tactnet::thread_pool&)>;

/// Trains on all threads.
using machine_training = machine (*)(feature_list, const label_list&, tactnet::thread_pool&);

machine train_linear(feature_list rows, const label_list& labels, double cost,
                     tactnet::thread_pool& threads) {
    auto result = tactnet::train_linear_machine(rows, labels, {.cost = cost}, threads);
    return [trained = std::move(result.machine)](feature_list some, tactnet::thread_pool&) {
        return trained.predict(some);
    };
}
machine linear_on_pixels(feature_list rows, const label_list& labels, tactnet::thread_pool& threads) {
    return train_linear(rows, labels, 1, threads);
}
machine linear_on_words(feature_list rows, const label_list& labels, tactnet::thread_pool& threads) {
    return train_linear(rows, labels, 10, threads); // as chosen with surf_settings
}
machine rbf_on_pixels(feature_list rows, const label_list& labels, tactnet::thread_pool& threads) {
    tactnet::kernel_training_options<tactnet::rbf_kernel> options;
    options.cost = 10;
    auto result = tactnet::train_kernel_machine(rows, labels, options, threads);
    return [trained = std::move(result.machine)](feature_list some, tactnet::thread_pool& pool) {
        return trained.predict(some, pool);
    };
}

class trained_machine final : public trained_network {
public:
    trained_machine(std::shared_ptr<const image_features> features, machine own,
                    std::vector<std::string> classes)
        : features_(std::move(features)), machine_(std::move(own)), classes_(std::move(classes)) {}

    const std::vector<std::string>& classes() const override { return classes_; }
    tactnet::evaluation evaluate(const tactnet::labelled_images& images, std::span<const std::size_t> chosen,
                                 tactnet::thread_pool& threads) const override {
        tactnet::evaluation result{
            std::numeric_limits<double>::quiet_NaN(), tactnet::confusion_matrix(images.classes), {}};
        if (chosen.empty())
            return result;
        const std::vector<float> rows = features_->rows(images.pixels, chosen, threads);
        result.recognised = machine_(feature_list(rows, features_->size()), threads);
        for (std::size_t i = 0; i < chosen.size(); ++i)
            result.confusion.add(images.labels[chosen[i]], result.recognised[i]);
        return result;
    }
    std::vector<float> logits(std::span<const std::uint8_t>, tactnet::thread_pool&) const override {
        throw std::logic_error("a support vector machine has no logits");
    }
    void save(const std::filesystem::path&, const tactnet::file_metadata&,
              std::span<const std::uint8_t>) const override {
        throw std::logic_error("a support vector machine is not saved by the program");
    }
    std::string header(const tactnet::header_description&, std::span<const std::uint8_t>) const override {
        throw std::logic_error("a support vector machine cannot be deployed");
    }

private:
    std::shared_ptr<const image_features> features_;
    machine machine_;
    std::vector<std::string> classes_;
};

/// The training of a machine: a single step.
class machine_run final : public training_run {
public:
    machine_run(std::shared_ptr<image_features> features, machine_training training,
                const tactnet::labelled_images& images, tactnet::data_split split,
                tactnet::thread_pool& threads)
        : features_(std::move(features)),
          train_(training),
          images_(images),
          split_(std::move(split)),
          threads_(threads) {}

    bool finished() const override { return !history_.empty(); }
    const tactnet::epoch_report& run_epoch() override {
        features_->fit(images_.pixels, split_.training, threads_);
        const std::vector<float> rows = features_->rows(images_.pixels, split_.training, threads_);
        label_list labels;
        for (const std::size_t image : split_.training)
            labels.push_back(images_.labels[image]);
        machine_ = train_(feature_list(rows, features_->size()), labels, threads_);
        return history_.emplace_back(tactnet::epoch_report{.epoch = 1});
    }
    const std::vector<tactnet::epoch_report>& history() const override { return history_; }
    std::size_t images_per_epoch() const override { return split_.training.size(); }
    const tactnet::data_split& split() const override { return split_; }
    void save_checkpoint(const std::filesystem::path&, const tactnet::file_metadata&) override {
        throw std::logic_error("the training of a support vector machine has no checkpoints");
    }
    void load_checkpoint(const std::filesystem::path&, const tactnet::file_metadata&) override {
        throw std::logic_error("the training of a support vector machine has no checkpoints");
    }
    std::unique_ptr<trained_network> best(const std::vector<std::string>& classes) const override {
        return std::make_unique<trained_machine>(features_, machine_, classes);
    }

private:
    std::shared_ptr<image_features> features_;
    machine_training train_;
    machine machine_;
    tactnet::labelled_images images_;
    tactnet::data_split split_;
    tactnet::thread_pool& threads_;
    std::vector<tactnet::epoch_report> history_;
};

class machine_method final : public method {
public:
    using feature_maker = std::function<std::unique_ptr<image_features>()>;

    machine_method(std::string_view name_, std::size_t rows_, std::size_t columns_, feature_maker features,
                   machine_training training)
        : method(name_, rows_, columns_, std::numeric_limits<std::size_t>::max()),
          features_(std::move(features)),
          train_(training) {}

    /// Of a machine trained on the paper's number of images of each class, which all are support vectors at
    /// the worst.
    network_costs costs(std::size_t classes) const override {
        const auto features = features_();
        const std::size_t inputs = features->size();
        network_costs result;
        if (train_ == &rbf_on_pixels)
            result.parameters = result.multiply_adds = classes * images_of_class * inputs;
        else
            result.parameters = classes * (inputs + 1), result.multiply_adds = classes * inputs;
        result.parameters += features->parameters();
        result.multiply_adds += features->multiply_adds();
        result.multiply_adds_on_pixels = result.multiply_adds;
        result.parameter_bytes = result.parameters * sizeof(float);
        result.activation_bytes = inputs * sizeof(float);
        return result;
    }
    frame_times time_frames() const override {
        // Made-up touches, as many as the paper trains with: the time of a machine depends on what it learnt.
        constexpr std::size_t classes = 22, count = classes * images_of_class;
        std::vector<std::uint8_t> pixels;
        label_list labels, all(count);
        std::iota(all.begin(), all.end(), std::size_t{0});
        for (std::uint32_t i = 0; i < count; ++i) {
            labels.push_back(i % classes);
            tactnet::random_stream random(1, tactnet::draw::order, i);
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
        const std::shared_ptr<image_features> features = features_();
        machine_run run(features, train_, {pixels, labels, classes}, {all, {}, {}}, alone);
        run.run_epoch();
        const auto trained = run.best({});
        const auto time = [&](std::size_t batch) {
            const auto some = std::span<const std::size_t>(all).first(batch);
            const tactnet::labelled_images images{pixels, labels, classes};
            return median_microseconds([&] { static_cast<void>(trained->evaluate(images, some, alone)); }) /
                   static_cast<double>(batch);
        };
        return {time(1), time(64)};
    }
    std::unique_ptr<training_run> train(const tactnet::recipe&, const tactnet::labelled_images& images,
                                        tactnet::data_split split, std::uint64_t,
                                        tactnet::thread_pool& threads) const override {
        return std::make_unique<machine_run>(features_(), train_, images, std::move(split), threads);
    }
    std::unique_ptr<trained_network> load(const tactnet::safetensors&, std::optional<double>) const override {
        throw usage_error(fmt::format("expected a network, found {}: `evaluate` trains and tests it", name));
    }

private:
    static constexpr std::size_t images_of_class = 32;

    feature_maker features_;
    machine_training train_;
};

} // namespace

bool is_machine(std::string_view name) {
    return name == "svm-linear" || name == "svm-rbf" || name == "surf-svm";
}

std::vector<std::unique_ptr<method>> make_machines(std::size_t rows, std::size_t columns,
                                                   std::unique_ptr<image_features> (*surf)()) {
    const auto pixels = [=](float scale) {
        return [=]() -> std::unique_ptr<image_features> {
            return std::make_unique<pixel_features>(rows * columns, scale);
        };
    };
    std::vector<std::unique_ptr<method>> list;
    const auto add = [&](std::string_view name, machine_method::feature_maker features,
                         machine_training train) {
        list.push_back(std::make_unique<machine_method>(name, rows, columns, std::move(features), train));
    };
    add("svm-linear", pixels(1.0f / 255), &linear_on_pixels);
    add("svm-rbf", pixels(1), &rbf_on_pixels);
    add("surf-svm", surf, &linear_on_words);
    return list;
}
