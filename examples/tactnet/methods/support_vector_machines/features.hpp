#pragma once

#include "methods/method.hpp"

#include <tactnet/io/safetensors/writer.hpp>

struct compiled_trunk;

/// What stands between images and a support vector machine.
class image_features {
public:
    virtual ~image_features() = default;
    /// Numbers of one image.
    virtual std::size_t size() const = 0;
    /// Costs of one image, without what is no product of two matrices; its parameters are those learnt.
    virtual method_costs costs() const { return {}; }
    /// How they are computed. A weight file has the same metadata, or it is for others.
    virtual tactnet::file_metadata form() const = 0;
    /// Everything else that decides what is learnt from some images.
    virtual tactnet::file_metadata fit_settings() const { return {}; }
    /// The part of the largest decision value by which values of the same image may differ where sums are
    /// rounded otherwise: on another processor.
    virtual double rounding() const = 0;
    /// Learns from the chosen images.
    virtual void fit(std::span<const std::uint8_t>, std::span<const std::size_t>, tactnet::thread_pool&) {}
    /// A row for each of the chosen images.
    virtual std::vector<float> rows(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen,
                                    tactnet::thread_pool& threads) const = 0;
    /// What was learnt, into a weight file and from one. `load` throws tactnet::file_error.
    virtual void save(tactnet::safetensors_writer&) const {}
    virtual void load(const weight_file&) {}
};

/// Makes features that are compiled for a size.
using make_features = std::unique_ptr<image_features>();

/// Adds support vector machines on images of one size and, on the features of each trunk, support vector
/// machines and heads. `surf` makes the features of the paper's baseline.
void add_methods_on_features(std::vector<std::unique_ptr<method>>& methods, tactnet::extent2d image,
                             make_features* surf,
                             const std::vector<std::shared_ptr<const compiled_trunk>>& trunks);
