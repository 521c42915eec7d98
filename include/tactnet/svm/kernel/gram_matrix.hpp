#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/kernels/rows/packed.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/svm/kernel/space.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cstddef>
#include <list>
#include <span>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Keeps the most recently used rows of a kernel matrix within a memory limit. Rows hold the active samples
/// only, padded with zeros to whole vectors.
class kernel_cache {
public:
    /// For `samples` rows of at most as many values, in at most `bytes`, but two rows at least.
    kernel_cache(std::size_t samples, std::size_t bytes)
        : stride_(pad_to_cache_line(samples)),
          capacity_(std::clamp(bytes / (stride_ * sizeof(float)), std::size_t{2},
                               std::max(samples, std::size_t{2}))),
          places_(samples, recent_.end()) {}

    // Places are iterators into the list of this object.
    kernel_cache(const kernel_cache&) = delete;
    kernel_cache& operator=(const kernel_cache&) = delete;

    /// The row of a sample: a stored one, or a new one filled by fill(out), which writes `columns` values.
    /// The pointer is valid until two other rows are requested.
    template <class Fill>
    [[nodiscard]] const float* row(std::size_t sample, std::size_t columns, const Fill& fill) {
        if (places_[sample] != recent_.end()) {
            recent_.splice(recent_.begin(), recent_, places_[sample]);
        } else {
            assign_place(sample);
            aligned_vector<float>& values = recent_.front().values;
            values.assign(stride_, 0.0F);
            fill(values.data());
            std::fill(values.begin() + static_cast<std::ptrdiff_t>(columns), values.end(), 0.0F);
        }
        return recent_.front().values.data();
    }

    /// Drops all columns but these, in rising order, and all rows but those of `samples`.
    void keep(std::span<const std::size_t> columns, std::span<const std::size_t> samples) {
        std::vector<bool> kept(places_.size());
        for (const std::size_t sample : samples)
            kept[sample] = true;
        for (auto place = recent_.begin(); place != recent_.end();) {
            if (!kept[place->sample]) {
                places_[place->sample] = recent_.end();
                place = recent_.erase(place);
                continue;
            }
            for (std::size_t k = 0; k < columns.size(); ++k)
                place->values[k] = place->values[columns[k]];
            std::fill(place->values.begin() + static_cast<std::ptrdiff_t>(columns.size()),
                      place->values.end(), 0.0F);
            ++place;
        }
    }
    void clear() {
        recent_.clear();
        std::fill(places_.begin(), places_.end(), recent_.end());
    }

private:
    struct entry {
        std::size_t sample;
        aligned_vector<float> values;
    };

    /// Puts a place for a new row in front. A full cache reuses the least recently used one.
    void assign_place(std::size_t sample) {
        if (recent_.size() < capacity_) {
            recent_.push_front({sample, {}});
        } else {
            places_[recent_.back().sample] = recent_.end();
            recent_.splice(recent_.begin(), recent_, std::prev(recent_.end()));
            recent_.front().sample = sample;
        }
        places_[sample] = recent_.begin();
    }

    std::size_t stride_, capacity_;
    std::list<entry> recent_; // most recently used first
    std::vector<std::list<entry>::iterator> places_;
};

// Rows of a kernel matrix for a solver that works on some of the samples: taken from the whole matrix, which
// one product computes for all problems over the same samples, or computed one by one if the matrix is too
// large.

/// A kernel of all pairs of samples.
class gram_matrix {
public:
    /// The bytes of the matrix of that many samples.
    [[nodiscard]] static double bytes(std::size_t samples) {
        return static_cast<double>(samples) * static_cast<double>(padded(samples)) * sizeof(float);
    }

    /// Products or squared distances of all pairs. One half is computed, the other mirrored.
    template <svm_kernel Kernel>
    [[nodiscard]] static gram_matrix measured(const placed_rows& rows, const kernel_columns<Kernel>& columns,
                                              thread_pool& threads) {
        const std::size_t n = columns.size();
        gram_matrix gram(n);
        constexpr std::size_t width = kernels::packed_rows::panel_width;
        threads.on_each_thread([&](thread_pool::share part) {
            for (std::size_t panel = part.index; panel * width < n; panel += part.threads) {
                const std::size_t first = panel * width;
                columns.measure_panel(first, rows, first, n - first, gram.row(first) + first, gram.stride_);
                for (std::size_t i = first + width; i < n; ++i)
                    for (std::size_t j = first; j < first + width; ++j)
                        gram.row(j)[i] = gram.row(i)[j];
            }
        });
        return gram;
    }
    /// Turns a matrix made by `measured` into values of the kernel.
    template <svm_kernel Kernel>
    void apply(const Kernel& kernel, double unit, thread_pool& threads) {
        threads.for_each(size_, [&](std::size_t i) { kernel.apply(row(i), stride_, unit); });
    }

    [[nodiscard]] std::size_t size() const { return size_; }
    [[nodiscard]] const float* row(std::size_t index) const { return values_.data() + index * stride_; }

private:
    explicit gram_matrix(std::size_t samples)
        : size_(samples), stride_(padded(samples)), values_(samples * stride_) {}

    [[nodiscard]] static std::size_t padded(std::size_t samples) {
        constexpr std::size_t width = kernels::packed_rows::panel_width;
        return detail::round_up(samples, width);
    }
    [[nodiscard]] float* row(std::size_t index) { return values_.data() + index * stride_; }

    std::size_t size_, stride_;
    aligned_vector<float> values_;
};

/// Rows taken from a whole matrix.
class stored_kernel_rows {
public:
    explicit stored_kernel_rows(const gram_matrix& gram) : gram_(&gram) {}

    /// From now on, rows hold the values with these samples, which must outlive the selection.
    void select(std::span<const std::size_t> samples) { samples_ = samples; }
    void fill(std::size_t sample, float* out) {
        const float* row = gram_->row(sample);
        for (std::size_t k = 0; k < samples_.size(); ++k)
            out[k] = row[samples_[k]];
    }
    [[nodiscard]] double diagonal(std::size_t sample) const { return double{gram_->row(sample)[sample]}; }

private:
    const gram_matrix* gram_;
    std::span<const std::size_t> samples_;
};

/// Rows computed one by one.
template <svm_kernel Kernel>
class computed_kernel_rows {
public:
    computed_kernel_rows(const placed_rows& rows, const kernel_space<Kernel>& space, const Kernel& kernel)
        : rows_(&rows), space_(&space), kernel_(kernel) {}

    void select(std::span<const std::size_t> samples) {
        columns_ = kernel_columns<Kernel>(*rows_, samples, space_->scale());
        scratch_.resize(columns_.padded_size());
    }
    void fill(std::size_t sample, float* out) {
        columns_.measure(*rows_, sample, 1, scratch_.data(), scratch_.size());
        kernel_.apply(scratch_.data(), scratch_.size(), space_->unit());
        std::copy_n(scratch_.begin(), columns_.size(), out);
    }
    [[nodiscard]] double diagonal(std::size_t sample) const {
        if constexpr (Kernel::of_distance)
            return 1;
        double norm = 0;
        for (const float value : rows_->original.row(sample))
            norm += double{value} * double{value};
        return norm;
    }

private:
    const placed_rows* rows_;
    const kernel_space<Kernel>* space_;
    Kernel kernel_;
    kernel_columns<Kernel> columns_;
    aligned_vector<float> scratch_;
};

}} // namespace tactnet
