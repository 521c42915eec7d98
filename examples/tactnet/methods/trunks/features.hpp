#pragma once

// Features of images by a trunk.

#include "data/image_data.hpp"
#include "methods/support_vector_machines/features.hpp"
#include "methods/trunks/compiled.hpp"

#include <tactnet/transfer/as_photograph.hpp>

#include <functional>
#include <mutex>

/// From images of one size to features, without weights.
struct feature_finder {
    std::shared_ptr<const compiled_trunk> trunk;
    bool pooled; ///< see feature_count
    tactnet::extent2d image;
    tactnet::photograph_preprocessing photograph = tactnet::torchvision_photograph;

    /// Numbers of one image.
    std::size_t size() const { return feature_count(trunk->map, pooled); }
    /// Photographs of one image.
    std::size_t views() const { return pooled ? 4 : 1; }
    /// Costs of one image.
    method_costs costs() const;
    /// The file that it needs.
    pretrained_file file() const;
    /// How features are computed. A weight file has the same metadata, or it is for others.
    tactnet::file_metadata describe() const;
    /// A row for each of the chosen images, `together` at a time: the same bits in any company and on any
    /// number of threads. Before each group, proceed(images that are done) may stop it. Throws
    /// std::runtime_error for features that are not finite.
    std::vector<float> find(
        const loaded_trunk& network, std::span<const std::uint8_t> images,
        std::span<const std::size_t> chosen, tactnet::thread_pool& threads,
        const std::function<bool(std::size_t)>& proceed = [](std::size_t) { return true; }) const;
    /// Frames through the trunk with random weights, and then use(features) for the rows of all of a call.
    frame_work work(std::function<void(std::span<const float>)> use) const;
    /// How many pass together at most.
    static constexpr std::size_t together = 16;
};

/// The part of the largest value by which what is found from features may differ on another processor: a
/// pixel of the photograph that lies half-way between two counts may be rounded to either.
inline constexpr double feature_rounding = 0.02;

/// A trunk with weights in a file, and its features of images of one size. The file is read when the first
/// image needs it. Const calls may come from any number of threads.
class trunk_features final : public image_features, public pretrained_weights {
public:
    /// Without weights, which `open` or `load` give.
    explicit trunk_features(feature_finder finder) : finder_(std::move(finder)) {}
    /// Takes a file with the arrays of the trunk, their names after `prefix`. Throws tactnet::file_error.
    void open(std::shared_ptr<tactnet::safetensors_source> file, std::string prefix);
    /// A file of pretrained weights. Throws tactnet::file_error.
    static std::shared_ptr<pretrained_weights> pretrained(const feature_finder& finder,
                                                          const std::filesystem::path& path);

    std::size_t size() const override { return finder_.size(); }
    method_costs costs() const override { return finder_.costs(); }
    tactnet::file_metadata form() const override { return finder_.describe(); }
    double rounding() const override { return feature_rounding; }
    /// The trunk in the weight file of a method on its features.
    void load(const weight_file& file) override;
    /// The trunk's arrays, as they are in the file. The writer reads them when it writes.
    void save(tactnet::safetensors_writer& writer) const override;

    bool prepare(const image_data& data, const std::filesystem::path& folder,
                 tactnet::thread_pool& threads) override;

    /// A row for each of the chosen images. Throws std::runtime_error for features that are not finite.
    std::vector<float> rows(std::span<const std::uint8_t> images, std::span<const std::size_t> chosen,
                            tactnet::thread_pool& threads) const override;

private:
    const loaded_trunk& network() const;
    /// What an earlier program kept in that file, or nothing.
    std::vector<float> read_kept(const std::filesystem::path& path, const tactnet::file_metadata& settings,
                                 std::size_t images) const;

    std::shared_ptr<tactnet::safetensors_source> file_;
    std::string prefix_;
    feature_finder finder_;
    mutable std::mutex mutex_; ///< of the file and of what is made of it
    mutable loaded_trunk network_;
    std::span<const std::uint8_t> kept_images_;
    std::vector<float> kept_; ///< the rows of these images
};
