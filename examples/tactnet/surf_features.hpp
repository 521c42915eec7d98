#pragma once

// Histograms of SURF words behind the interface of machines.hpp. Included only by the generated units.

#include "machines.hpp"

#include <tactnet/features/surf_words.hpp>

#include <optional>

template <tactnet::shape Shape>
class surf_features final : public image_features {
    using surf = tactnet::dense_surf<Shape>;
    static constexpr std::size_t words = 500;

public:
    std::size_t size() const override { return words; }
    std::size_t multiply_adds() const override { return surf::most * words * tactnet::surf_values; }
    std::size_t parameters() const override { return words * tactnet::surf_values; }
    void fit(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen,
             tactnet::thread_pool& threads) override {
        words_.emplace(tactnet::fit_surf_words<surf, words>(images, chosen, {}, threads));
    }
    std::vector<float> rows(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen,
                            tactnet::thread_pool& threads) const override {
        const auto histograms = tactnet::surf_histograms<surf>(images, chosen, *words_, threads);
        return {histograms.begin(), histograms.end()};
    }

private:
    std::optional<tactnet::bag_of_words<tactnet::surf_values, words>> words_;
};
