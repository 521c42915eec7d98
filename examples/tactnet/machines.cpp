#include "machines.hpp"

#include "stopwatch.hpp"

#include <tactnet/features/surf_words.hpp>
#include <tactnet/io/svm_file.hpp>
#include <tactnet/io/text.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/svm.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <stdexcept>
#include <utility>
#include <variant>

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
    tactnet::file_metadata form() const override {
        return {{"features", "pixels"}, {"input", "scale"}, {"input_scale", fmt::to_string(scale_)}};
    }
    tactnet::file_metadata fit_settings() const override { return {}; }
    double rounding() const override { return 1e-3; }
    void fit(std::span<const std::uint8_t>, std::span<const std::size_t>, tactnet::thread_pool&) override {}
    std::vector<float> rows(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen,
                            tactnet::thread_pool&) const override {
        std::vector<float> result;
        for (const std::size_t image : chosen)
            for (const std::uint8_t count : images.subspan(image * pixels_, pixels_))
                result.push_back(static_cast<float>(count) * scale_);
        return result;
    }
    void save(tactnet::safetensors_writer&) const override {}
    void load(const tactnet::safetensors&) override {}

private:
    std::size_t pixels_;
    float scale_;
};

using linear_machine = tactnet::linear_machine<>;
using rbf_machine = tactnet::kernel_machine<tactnet::rbf_kernel>;
using linear_options = tactnet::linear_training_options;
using rbf_options = tactnet::kernel_training_options<tactnet::rbf_kernel>;

/// A machine of either kind.
class machine {
public:
    machine(linear_machine own) : own_(std::move(own)) {}
    machine(rbf_machine own) : own_(std::move(own)) {}

    std::size_t features() const {
        return std::visit([](const auto& own) { return own.features(); }, own_);
    }
    /// Of the classes that it was trained on.
    const label_list& labels() const {
        return std::visit([](const auto& own) -> const label_list& { return own.parameters().labels; }, own_);
    }
    void add_to(tactnet::safetensors_writer& writer) const {
        std::visit([&](const auto& own) { tactnet::add_machine(writer, own); }, own_);
    }
    /// The values that decide, a row for each row.
    std::vector<double> values(feature_list rows, tactnet::thread_pool& threads) const {
        if (const auto* linear = std::get_if<linear_machine>(&own_))
            return linear->decision_values(rows);
        return std::get<rbf_machine>(own_).decision_values(rows, threads);
    }
    /// What such a row stands for. The score is the smallest value in favour of the class.
    recognition decide(std::span<const double> values) const {
        const std::size_t classes = labels().size();
        const bool pairs = std::holds_alternative<rbf_machine>(own_);
        const std::size_t found = tactnet::decide(values, classes,
                                                  pairs ? tactnet::multiclass::one_versus_one
                                                        : tactnet::multiclass::one_versus_rest);
        double score = values[found];
        if (pairs) {
            score = std::numeric_limits<double>::infinity();
            std::size_t m = 0;
            for (const auto& [first, second] : tactnet::class_pairs(classes)) {
                if (first == found || second == found)
                    score = std::min(score, first == found ? values[m] : -values[m]);
                ++m;
            }
        }
        if (!std::isfinite(score))
            throw std::runtime_error(
                "expected finite decision values, found some that are not: the weights are broken");
        return {labels()[found], score};
    }

private:
    std::variant<linear_machine, rbf_machine> own_;
};

// The two ways of training, and of reading what came of it.

machine train_machine(feature_list rows, const label_list& labels, const linear_options& options,
                      tactnet::thread_pool& threads) {
    return tactnet::train_linear_machine(rows, labels, options, threads).machine;
}
machine train_machine(feature_list rows, const label_list& labels, const rbf_options& options,
                      tactnet::thread_pool& threads) {
    return tactnet::train_kernel_machine(rows, labels, options, threads).machine;
}
machine load_machine(const tactnet::safetensors& file, const linear_options&) {
    return tactnet::load_linear_machine(file);
}
machine load_machine(const tactnet::safetensors& file, const rbf_options&) {
    return tactnet::load_kernel_machine<tactnet::rbf_kernel>(file);
}
tactnet::file_metadata own_settings(const linear_options& o) {
    return {{"kernel", "linear"},
            {"multiclass", "one versus rest"},
            {"loss", o.solver.loss == tactnet::linear_loss::hinge ? "hinge" : "squared hinge"},
            {"bias", fmt::to_string(o.bias)},
            {"solver_seed", fmt::to_string(o.solver.seed)}};
}
tactnet::file_metadata own_settings(const rbf_options& o) {
    return {
        {"kernel", "rbf"},
        {"multiclass",
         o.scheme == tactnet::multiclass::one_versus_one ? "one versus one" : "one versus rest"},
        {"gamma_rule", o.kernel.gamma ? fmt::to_string(*o.kernel.gamma) : "scale"},
        {"shrinking", fmt::to_string(o.solver.shrinking)},
        {"cache_bytes", fmt::to_string(o.solver.cache_bytes)}, // rows that are computed apart round otherwise
    };
}

/// Of a machine: which one, what it is trained with and what stands before it.
struct machine_recipe {
    std::string_view name;
    std::variant<linear_options, rbf_options> options;
    float pixel_scale; ///< 0: not pixels but words

    bool is_linear() const { return std::holds_alternative<linear_options>(options); }

    /// All but the images that decides what comes of a training, features apart.
    tactnet::file_metadata describe() const {
        return std::visit(
            [](const auto& o) {
                tactnet::file_metadata text = own_settings(o);
                text["cost"] = fmt::to_string(o.cost);
                text["standardise"] = fmt::to_string(o.standardise);
                text["tolerance"] = fmt::to_string(o.solver.tolerance);
                text["iteration_limit"] = fmt::to_string(o.solver.iteration_limit);
                return text;
            },
            options);
    }
};

const std::array<machine_recipe, 3>& recipes() {
    static const std::array<machine_recipe, 3> all{{
        {"svm-linear", linear_options{.cost = 1}, 1.0f / 255},
        {"svm-rbf", rbf_options{.cost = 10}, 1},
        {"surf-svm", linear_options{.cost = tactnet::surf_settings{}.cost}, 0},
    }};
    return all;
}

class trained_machine final : public trained_method {
public:
    trained_machine(tactnet::extent image, std::shared_ptr<const image_features> features, machine own,
                    std::vector<std::string> classes)
        : image_(image),
          features_(std::move(features)),
          machine_(std::move(own)),
          classes_(std::move(classes)) {}

    const std::vector<std::string>& classes() const override { return classes_; }
    tactnet::evaluation evaluate(const tactnet::labelled_images& images, std::span<const std::size_t> chosen,
                                 tactnet::thread_pool& threads) const override {
        tactnet::evaluation result{
            std::numeric_limits<double>::quiet_NaN(), tactnet::confusion_matrix(images.classes), {}};
        for (const recognition& found : recognise_chosen(images.pixels, chosen, threads)) {
            result.confusion.add(images.labels[chosen[result.recognised.size()]], found.label);
            result.recognised.push_back(found.label);
        }
        return result;
    }
    std::vector<recognition> recognise(std::span<const std::uint8_t> images,
                                       tactnet::thread_pool& threads) const override {
        return recognise_chosen(images, all_of(images), threads);
    }
    void save(const std::filesystem::path& path, const tactnet::file_metadata& metadata,
              std::span<const std::uint8_t> selftest) const override {
        tactnet::safetensors_writer writer;
        writer.metadata = metadata;
        writer.metadata["classes"] = nlohmann::json(classes_).dump();
        features_->save(writer);
        machine_.add_to(writer);
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
    std::vector<double> values_of(std::span<const std::uint8_t> images, const label_list& chosen,
                                  tactnet::thread_pool& threads) const {
        const std::vector<float> rows = features_->rows(images, chosen, threads);
        return machine_.values(feature_list(rows, features_->size()), threads);
    }
    std::vector<recognition> recognise_chosen(std::span<const std::uint8_t> images,
                                              std::span<const std::size_t> chosen,
                                              tactnet::thread_pool& threads) const {
        std::vector<recognition> result;
        if (chosen.empty())
            return result;
        const std::vector<double> values = values_of(images, {chosen.begin(), chosen.end()}, threads);
        const std::size_t each = values.size() / chosen.size();
        for (std::size_t i = 0; i < chosen.size(); ++i)
            result.push_back(machine_.decide(std::span(values).subspan(i * each, each)));
        return result;
    }

    tactnet::extent image_;
    std::shared_ptr<const image_features> features_;
    machine machine_;
    std::vector<std::string> classes_;
};

/// The training of a machine: a single step.
class machine_run final : public training_run {
public:
    machine_run(tactnet::extent image, std::shared_ptr<image_features> features, const machine_recipe& recipe,
                const tactnet::labelled_images& images, tactnet::data_split split,
                tactnet::thread_pool& threads)
        : image_(image),
          features_(std::move(features)),
          recipe_(recipe),
          images_(images),
          split_(std::move(split)),
          threads_(threads) {}

    bool finished() const override { return machine_.has_value(); }
    void advance() override {
        features_->fit(images_.pixels, split_.training, threads_);
        const std::vector<float> rows = features_->rows(images_.pixels, split_.training, threads_);
        label_list labels;
        for (const std::size_t image : split_.training)
            labels.push_back(images_.labels[image]);
        machine_ = std::visit(
            [&](const auto& options) {
                return train_machine(feature_list(rows, features_->size()), labels, options, threads_);
            },
            recipe_.options);
    }
    const tactnet::data_split& split() const override { return split_; }
    std::unique_ptr<trained_method> best(const std::vector<std::string>& classes) const override {
        return std::make_unique<trained_machine>(image_, features_, *machine_, classes);
    }

private:
    tactnet::extent image_;
    std::shared_ptr<image_features> features_;
    const machine_recipe& recipe_;
    std::optional<machine> machine_;
    tactnet::labelled_images images_;
    tactnet::data_split split_;
    tactnet::thread_pool& threads_;
};

class machine_method final : public method {
public:
    using feature_maker = std::function<std::unique_ptr<image_features>()>;

    machine_method(const machine_recipe& recipe, std::size_t rows_, std::size_t columns_,
                   feature_maker features)
        : method(recipe.name, rows_, columns_, std::numeric_limits<std::size_t>::max()),
          recipe_(recipe),
          features_(std::move(features)) {}

    tactnet::file_metadata describe(const tactnet::recipe&) const override {
        const auto features = features_();
        tactnet::file_metadata text = recipe_.describe();
        text.merge(features->form());
        text.merge(features->fit_settings());
        return text;
    }
    /// Of a machine trained on the paper's number of images of each class, which all are support vectors at
    /// the worst.
    network_costs costs(std::size_t classes) const override {
        const auto features = features_();
        const std::size_t inputs = features->size();
        network_costs result;
        if (recipe_.is_linear())
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
    frame_times time_frames() const override {
        // Made-up touches, as many as the paper trains with: the time of a machine depends on what it learnt.
        constexpr std::size_t classes = 22, count = classes * images_of_class;
        std::vector<std::uint8_t> pixels;
        label_list labels;
        const label_list all = tactnet::all_samples(count);
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
        machine_run run({rows, columns}, features_(), recipe_, {pixels, labels, classes}, {all, {}, {}},
                        alone);
        run.advance();
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
        return std::make_unique<machine_run>(tactnet::extent{rows, columns}, features_(), recipe_, images,
                                             std::move(split), threads);
    }
    std::unique_ptr<trained_method> load(const tactnet::safetensors& file,
                                         std::optional<double>) const override {
        const tactnet::model_description says = tactnet::describe_model(file);
        machine own =
            std::visit([&](const auto& options) { return load_machine(file, options); }, recipe_.options);
        const auto require = [&](const std::string& key, const std::string& expected) {
            const auto found = file.metadata().find(key);
            if (found == file.metadata().end() || found->second != expected)
                throw tactnet::file_error(
                    file.file(), fmt::format("metadata '{}'", key), tactnet::in_quotes(expected),
                    found == file.metadata().end() ? "none" : tactnet::in_quotes(found->second));
        };
        require("rows", fmt::to_string(rows));
        require("columns", fmt::to_string(columns));
        std::shared_ptr<image_features> features = features_();
        for (const auto& [key, expected] : features->form())
            require(key, expected);
        features->load(file);
        if (own.features() != features->size())
            throw tactnet::file_error(file.file(), "", fmt::format("{} features", features->size()),
                                      fmt::to_string(own.features()));
        if (own.labels().back() >= says.classes.size()) // they rise
            throw tactnet::file_error(file.file(), "tensor 'labels'",
                                      fmt::format("labels of {} classes", says.classes.size()),
                                      fmt::to_string(own.labels().back()));
        auto trained = std::make_unique<trained_machine>(tactnet::extent{rows, columns}, std::move(features),
                                                         std::move(own), says.classes);
        trained->check_selftest(file);
        return trained;
    }

private:
    static constexpr std::size_t images_of_class = 32;

    const machine_recipe& recipe_;
    feature_maker features_;
};

} // namespace

bool is_machine(std::string_view name) {
    return std::any_of(recipes().begin(), recipes().end(),
                       [&](const machine_recipe& recipe) { return recipe.name == name; });
}

std::vector<std::unique_ptr<method>> make_machines(std::size_t rows, std::size_t columns,
                                                   std::unique_ptr<image_features> (*surf)()) {
    std::vector<std::unique_ptr<method>> list;
    for (const machine_recipe& recipe : recipes()) {
        machine_method::feature_maker features = surf;
        if (recipe.pixel_scale > 0)
            features = [=]() -> std::unique_ptr<image_features> {
                return std::make_unique<pixel_features>(rows * columns, recipe.pixel_scale);
            };
        list.push_back(std::make_unique<machine_method>(recipe, rows, columns, std::move(features)));
    }
    return list;
}
