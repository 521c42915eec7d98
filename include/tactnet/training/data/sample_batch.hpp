#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/lowering/input_function.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Interleaved samples as in tensor/batch.hpp, of a size known at run time.
class sample_batch {
public:
    static constexpr std::size_t lanes = kernels::lanes<float>;

    /// `size` is the number of values in a sample.
    explicit sample_batch(std::size_t size, std::size_t samples = 0) : size_(size) { resize(samples); }

    /// Afterwards all elements are zero. Keeps its memory when it shrinks.
    void resize(std::size_t samples) {
        samples_ = samples;
        elements_.assign(kernels::padded_size<float>(samples) * size_, 0);
    }
    [[nodiscard]] std::size_t samples() const { return samples_; }
    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] float* data() { return elements_.data(); }
    [[nodiscard]] const float* data() const { return elements_.data(); }
    /// All elements, including lanes without a sample.
    [[nodiscard]] std::span<const float> elements() const { return elements_; }
    [[nodiscard]] float operator()(std::size_t sample, std::size_t element) const {
        return elements_[(sample / lanes * size_ + element) * lanes + sample % lanes];
    }
    void set(std::size_t sample, std::span<const float> values) {
        float* const to = elements_.data() + sample / lanes * size_ * lanes + sample % lanes;
        for (std::size_t e = 0; e < size_; ++e)
            to[e * lanes] = values[e];
    }

private:
    std::size_t size_, samples_ = 0;
    aligned_vector<float> elements_;
};

/// The input batch of a network: images of counts as (function of count − mean) × scale. Features keep a mean
/// of zero and a scale of 1.
class normalised_batch {
public:
    /// `size` is the number of pixels. The mean is zero and the scale 1 until set.
    normalised_batch(std::size_t size, thread_pool& threads)
        : threads_(threads), mean_(size), samples_(size) {}

    /// Before subtract_mean.
    void compress(const input_function& function) { function_ = function; }
    [[nodiscard]] const input_function& function() const { return function_; }
    /// Subtracts the mean of the chosen images, one or more, summed in integers without rounding errors; of
    /// compressed ones in double.
    void subtract_mean(std::span<const std::uint8_t> pixels, std::span<const std::size_t> chosen) {
        if (!function_.identity()) {
            std::vector<double> sums(mean_.size());
            std::vector<float> image(mean_.size());
            for (const std::size_t i : chosen) {
                const auto counts = pixels.subspan(i * image.size(), image.size());
                std::copy(counts.begin(), counts.end(), image.begin());
                function_.apply(image);
                for (std::size_t e = 0; e < image.size(); ++e)
                    sums[e] += static_cast<double>(image[e]);
            }
            for (std::size_t e = 0; e < image.size(); ++e)
                mean_[e] = static_cast<float>(sums[e] / static_cast<double>(chosen.size()));
            return;
        }
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

    /// Fills the batch: make(i, counts) writes the counts of image i, on any thread.
    template <class Make>
    void fill(std::size_t count, const Make& make) {
        samples_.resize(count);
        at_work_.resize(threads_.threads() * mean_.size());
        threads_.on_each_thread([&](thread_pool::share share) {
            const auto counts = std::span(at_work_).subspan(share.index * mean_.size(), mean_.size());
            for (std::size_t i = share.begin(count); i < share.end(count); ++i) {
                make(i, counts);
                function_.apply(counts);
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
    input_function function_;
    sample_batch samples_;
    std::vector<float> at_work_; ///< an image for each thread
};

}} // namespace tactnet
