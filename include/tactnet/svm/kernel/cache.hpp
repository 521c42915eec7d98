#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <algorithm>
#include <cstddef>
#include <list>
#include <span>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Rows of a kernel matrix, those used last, within a bound on memory. Rows are of the active samples alone,
/// padded with zeros to whole vectors.
class kernel_cache {
public:
    /// For `samples` rows of at most as many values, in at most `bytes`, but two rows at least.
    kernel_cache(std::size_t samples, std::size_t bytes)
        : stride_(whole_lines(samples)),
          capacity_(std::clamp(bytes / (stride_ * sizeof(float)), std::size_t{2},
                               std::max(samples, std::size_t{2}))),
          places_(samples, recent_.end()) {}

    // Places are iterators into the list here.
    kernel_cache(const kernel_cache&) = delete;
    kernel_cache& operator=(const kernel_cache&) = delete;

    /// The row of a sample: as it was kept, or filled by fill(out), which writes `columns` values. It stays
    /// where it is until two others have been asked for.
    template <class Fill>
    [[nodiscard]] const float* row(std::size_t sample, std::size_t columns, const Fill& fill) {
        if (places_[sample] != recent_.end()) {
            recent_.splice(recent_.begin(), recent_, places_[sample]);
        } else {
            take_place(sample);
            aligned_vector<float>& values = recent_.front().values;
            values.assign(stride_, 0.0F);
            fill(values.data());
            std::fill(values.begin() + static_cast<std::ptrdiff_t>(columns), values.end(), 0.0F);
        }
        return recent_.front().values.data();
    }

    /// Leaves only some columns, in rising order, and the rows of these.
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

    /// A place for a new row in front, if need be that of the row not used for longest.
    void take_place(std::size_t sample) {
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
    std::list<entry> recent_; // the last used in front
    std::vector<std::list<entry>::iterator> places_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
