#pragma once

#include "methods/method.hpp"

#include <tactnet/io/safetensors/writer.hpp>

#include <cstddef>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

/// What stands between images and a support vector machine.
class image_features {
public:
    virtual ~image_features() = default;
    /// Numbers of one image.
    virtual std::size_t size() const = 0;
    /// Multiply-adds of one image, apart from what is no product of two matrices.
    virtual std::size_t multiply_adds() const = 0;
    /// Numbers that are learnt.
    virtual std::size_t parameters() const = 0;
    /// How they are computed. A weight file says the same, or it is for others.
    virtual tactnet::file_metadata form() const = 0;
    /// All else that decides what is learnt from some images.
    virtual tactnet::file_metadata fit_settings() const = 0;
    /// The part of the largest decision value by which values of the same image may differ where sums are
    /// rounded otherwise: on another processor.
    virtual double rounding() const = 0;
    /// Learns from the chosen images.
    virtual void fit(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen,
                     tactnet::thread_pool& threads) = 0;
    /// A row for each of the chosen images.
    virtual std::vector<float> rows(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen,
                                    tactnet::thread_pool& threads) const = 0;
    /// What was learnt, into a weight file and from one. `load` throws tactnet::file_error.
    virtual void save(tactnet::safetensors_writer& writer) const = 0;
    virtual void load(const weight_file& file) = 0;
};
