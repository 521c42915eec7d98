#pragma once

#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/training/data/sample_batch.hpp>

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// The batch in front of a network: images of counts, each as (count − mean) × scale. Features have no mean
/// and a scale of 1: they are what they are.
class input_batch {
public:
    /// Images of `size` pixels, made on `threads`. Until told otherwise nothing is subtracted, and the scale
    /// is 1.
    input_batch(std::size_t size, thread_pool& threads) : threads_(threads), mean_(size), samples_(size) {}

    /// Subtracts the mean of the chosen images, one or more; summed in integers, so that no rounding adds up.
    void subtract_mean(std::span<const std::uint8_t> pixels, std::span<const std::size_t> chosen) {
        for (std::size_t e = 0; e < mean_.size(); ++e) {
            std::uint64_t sum = 0;
            for (const std::size_t image : chosen)
                sum += pixels[image * mean_.size() + e];
            mean_[e] = static_cast<float>(static_cast<double>(sum) / static_cast<double>(chosen.size()));
        }
    }
    void scale_by(float scale) { scale_ = scale; }
    [[nodiscard]] std::span<const float> mean() const { return mean_; }
    [[nodiscard]] float scale() const { return scale_; }

    /// `count` images; make(i, counts) writes the counts of image i, on any thread.
    template <class Make>
    void fill(std::size_t count, const Make& make) {
        samples_.resize(count);
        at_work_.resize(threads_.threads() * mean_.size());
        threads_.on_each_thread([&](thread_pool::share share) {
            const auto counts = std::span(at_work_).subspan(share.index * mean_.size(), mean_.size());
            for (std::size_t i = share.begin(count); i < share.end(count); ++i) {
                make(i, counts);
                for (std::size_t e = 0; e < counts.size(); ++e)
                    counts[e] = (counts[e] - mean_[e]) * scale_;
                samples_.set(i, counts);
            }
        });
    }
    [[nodiscard]] const sample_batch& samples() const { return samples_; }

private:
    thread_pool& threads_;
    std::vector<float> mean_;
    float scale_ = 1;
    sample_batch samples_;
    std::vector<float> at_work_; ///< an image for each thread
};

} // namespace TACTNET_ARCH
} // namespace tactnet
