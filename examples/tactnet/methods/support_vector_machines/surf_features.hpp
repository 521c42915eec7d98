#pragma once

// Histograms of SURF words as in the paper's baseline. Included only by the generated units.

#include "methods/support_vector_machines/features.hpp"

#include <tactnet/features/bag_of_words.hpp>

#include <fmt/format.h>
#include <fmt/ranges.h>

template <tactnet::shape Shape>
class surf_features final : public image_features {
    static constexpr tactnet::surf_grid grid{};
    static constexpr tactnet::surf_settings settings{};
    static constexpr std::size_t words = 500;
    using surf = tactnet::dense_surf<Shape, grid>;
    using vocabulary = tactnet::bag_of_words<tactnet::surf_values, words>;

public:
    std::size_t size() const override { return words; }
    method_costs costs() const override {
        method_costs all;
        all.parameters = words * tactnet::surf_values;
        all.multiply_adds = all.multiply_adds_on_pixels = surf::most * all.parameters;
        return all;
    }
    tactnet::file_metadata form() const override {
        return {{"features", "histograms of surf words"},
                {"surf_step", fmt::format("{}x{}", grid.step.rows, grid.step.columns)},
                {"surf_scales", fmt::to_string(fmt::join(std::span(grid.scales).first(grid.levels()), " "))},
                {"histogram",
                 settings.form == tactnet::histogram_form::counts ? "counts" : "square roots of counts"},
                {"input", "scale"},
                {"input_scale", "1"}};
    }
    tactnet::file_metadata fit_settings() const override {
        return {{"words", fmt::to_string(words)},
                {"word_descriptors", fmt::to_string(settings.max_descriptors)},
                {"word_iterations", fmt::to_string(settings.max_iterations)},
                {"word_seed", fmt::to_string(settings.seed)}};
    }
    /// A descriptor that lies between two words may count for either, which is no small change.
    double rounding() const override { return 0.2; }
    void fit(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen,
             tactnet::thread_pool& threads) override {
        words_.emplace(tactnet::fit_surf_words<surf, words>(images, chosen, settings, threads));
    }
    std::vector<float> rows(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen,
                            tactnet::thread_pool& threads) const override {
        const auto histograms = tactnet::surf_histograms<surf>(images, chosen, *words_, threads);
        return {histograms.begin(), histograms.end()};
    }
    void save(tactnet::safetensors_writer& writer) const override {
        writer.add("surf.words", {words_->count(), tactnet::surf_values}, words_->words());
    }
    void load(const weight_file& from) override {
        const tactnet::safetensors& file = from.arrays;
        const std::vector<float> values = file.values<float>("surf.words");
        file.require_extents("surf.words",
                             std::vector{values.size() / tactnet::surf_values, tactnet::surf_values});
        try {
            words_.emplace(values, settings.form);
        } catch (const std::invalid_argument& error) { // none, too many, numbers without end
            throw tactnet::file_error(file.file(), "tensor 'surf.words'", "a vocabulary",
                                      fmt::format("'{}'", error.what()));
        }
    }

private:
    std::optional<vocabulary> words_;
};
