#pragma once

#include "methods/support_vector_machines/image_features.hpp"

#include <fmt/format.h>

/// The counts of an image as they are, or multiplied by a scale.
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
    void load(const weight_file&) override {}

private:
    std::size_t pixels_;
    float scale_;
};
