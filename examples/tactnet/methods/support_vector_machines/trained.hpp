#pragma once

#include "methods/in_parts.hpp"
#include "methods/support_vector_machines/image_features.hpp"
#include "methods/support_vector_machines/machine.hpp"

#include <tactnet/text/quoting.hpp>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// A support vector machine with the features in front of it.
class trained_svm final : public trained_method {
public:
    trained_svm(tactnet::extent2d image, std::shared_ptr<const image_features> features,
                support_vector_machine own, std::vector<std::string> classes)
        : image_(image), features_(std::move(features)), own_(std::move(own)), classes_(std::move(classes)) {}

    const std::vector<std::string>& classes() const override { return classes_; }
    tactnet::evaluation evaluate(const tactnet::labelled_images& images, std::span<const std::size_t> chosen,
                                 tactnet::thread_pool& threads) const override {
        tactnet::evaluation result{
            std::numeric_limits<double>::quiet_NaN(), tactnet::confusion_matrix(images.classes), {}};
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
    std::vector<double> values_of(std::span<const std::uint8_t> images, const label_list& chosen,
                                  tactnet::thread_pool& threads) const {
        const std::vector<float> rows = features_->rows(images, chosen, threads);
        return own_.values(feature_list(rows, features_->size()), threads);
    }
    std::vector<scored_class> recognise_chosen(std::span<const std::uint8_t> images,
                                               std::span<const std::size_t> chosen,
                                               tactnet::thread_pool& threads) const {
        const std::size_t each = own_.machines();
        std::vector<scored_class> result;
        in_parts(
            chosen.size(), each * sizeof(double) + features_->size() * sizeof(float),
            [&](std::size_t first, std::size_t count) {
                const auto part = chosen.subspan(first, count);
                const std::vector<double> values = values_of(images, {part.begin(), part.end()}, threads);
                for (std::size_t i = 0; i < count; ++i)
                    result.push_back(own_.decide(std::span(values).subspan(i * each, each)));
            });
        return result;
    }

    tactnet::extent2d image_;
    std::shared_ptr<const image_features> features_;
    support_vector_machine own_;
    std::vector<std::string> classes_;
};
