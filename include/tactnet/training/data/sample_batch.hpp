#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <cstddef>
#include <span>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Samples side by side as in tensor/batch.hpp, of a size that is known only when running.
class sample_batch {
public:
    static constexpr std::size_t lanes = kernels::lanes<float>;

    /// `size` numbers in each sample.
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
    /// All of them, those of no sample too.
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

} // namespace TACTNET_ARCH
} // namespace tactnet
