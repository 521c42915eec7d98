#pragma once

#include <tactnet/kernels/simd/vector.hpp>
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

}} // namespace tactnet
