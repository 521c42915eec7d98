#pragma once

#include <tactnet/kernels/rows/packed.hpp>
#include <tactnet/kernels/simd/special_functions.hpp>
#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/tensor/aligned.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// Kernels, which measure the similarity of two samples: functions of their product or of their squared
// distance, which are computed for whole matrices at once.

namespace tactnet { inline namespace TACTNET_ARCH {

/// x · y
struct linear_kernel {
    static constexpr bool of_distance = false;
    static constexpr std::string_view name = "linear";

    /// The kernel with the parameters that depend on the training set.
    [[nodiscard]] linear_kernel fitted(feature_rows<>) const { return *this; }
    /// Turns `count` products into values of the kernel.
    void apply(float*, std::size_t, double) const {}
};

namespace detail {

/// The variance of all values together, whichever feature they belong to.
[[nodiscard]] inline double variance_of_all(feature_rows<> rows) {
    const double count = static_cast<double>(rows.values().size());
    double sum = 0, squares = 0;
    for (const float value : rows.values())
        sum += double{value};
    const double mean = sum / count;
    for (const float value : rows.values())
        squares += (double{value} - mean) * (double{value} - mean);
    return count > 0 ? squares / count : 0;
}

} // namespace detail

/// exp(−γ ‖x − y‖²)
struct rbf_kernel {
    static constexpr bool of_distance = true;
    static constexpr std::string_view name = "rbf";

    /// γ, at least 0. Empty is "scale": 1 / (features × variance of all values of the training set), or 1 if
    /// these are all the same.
    std::optional<double> gamma;

    [[nodiscard]] rbf_kernel fitted(feature_rows<> rows) const {
        if (gamma && !(*gamma >= 0 && *gamma <= std::numeric_limits<double>::max()))
            detail::throw_invalid_argument(
                {"gamma: expected a finite number of 0 or more, found ", std::to_string(*gamma)});
        if (gamma)
            return *this;
        const double variance = detail::variance_of_all(rows);
        return {variance > 0 ? 1 / (static_cast<double>(rows.features()) * variance) : 1.0};
    }
    /// Turns `count` squared distances, in units of `unit`, into values of the kernel. Fitted kernels only.
    void apply(float* distances, std::size_t count, double unit) const {
        // A factor beyond float gives the same as the largest: 1 at distance 0, else 0.
        const double factor = std::min(*gamma * unit, double{std::numeric_limits<float>::max()});
        kernels::negative_exponentials(distances, count, static_cast<float>(factor));
    }
};

template <class Kernel>
concept svm_kernel = requires(const Kernel kernel, feature_rows<> rows, float* values, std::size_t count) {
    { Kernel::of_distance } -> std::convertible_to<bool>;
    { Kernel::name } -> std::convertible_to<std::string_view>;
    { kernel.fitted(rows) } -> std::same_as<Kernel>;
    kernel.apply(values, count, 1.0);
};

// Products or squared distances of many samples at once. ‖x − y‖² = ‖x‖² + ‖y‖² − 2 x·y is one matrix
// product, but cancels where the samples lie far from the origin, or close to each other. So distances are
// taken around the middle of the samples and in a unit of their size, and close pairs are measured once more
// directly.

/// Samples in the coordinates of a kernel space.
struct placed_rows {
    feature_rows<> original;
    aligned_vector<float> moved; ///< centred and in units; empty for kernels of products
    aligned_vector<float> norms; ///< ‖·‖² of the moved rows
    [[nodiscard]] const float* row(std::size_t index) const {
        return (moved.empty() ? original.values().data() : moved.data()) + index * original.features();
    }
    [[nodiscard]] float norm(std::size_t index) const { return norms.empty() ? 0.0F : norms[index]; }
};

/// The origin and unit of length for samples near given ones.
template <svm_kernel Kernel>
class kernel_space {
public:
    kernel_space() = default;
    /// Throws std::invalid_argument when the products of the samples do not fit into float.
    explicit kernel_space(feature_rows<> samples) {
        if constexpr (Kernel::of_distance)
            centre_on(samples);
        else
            check_products(samples);
    }

    /// The square of the unit of length, the factor from squared distances to those of the features.
    [[nodiscard]] double unit() const { return 1 / (double{scale_} * double{scale_}); }
    [[nodiscard]] float scale() const { return scale_; }

    /// The rows must outlive the result.
    [[nodiscard]] placed_rows place(feature_rows<> rows) const {
        placed_rows result{rows, {}, {}};
        if constexpr (Kernel::of_distance) {
            const std::size_t features = rows.features();
            result.moved.resize(rows.size() * features);
            result.norms.resize(rows.size());
            for (std::size_t i = 0; i < rows.size(); ++i) {
                const float* from = rows.values().data() + i * features;
                float* to = result.moved.data() + i * features;
                double norm = 0;
                for (std::size_t f = 0; f < features; ++f) {
                    to[f] = std::clamp((from[f] - centre_[f]) * scale_, -farthest, farthest);
                    norm += double{to[f]} * double{to[f]};
                }
                result.norms[i] = static_cast<float>(norm);
            }
        }
        return result;
    }

private:
    /// Rows are clamped to this many times the extent of the samples, so that their squares add up within
    /// float.
    static constexpr float farthest = 0x1p50F;

    void centre_on(feature_rows<> samples) {
        const std::size_t features = samples.features();
        std::vector<double> sums(features);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const float* row = samples.values().data() + i * features;
            for (std::size_t f = 0; f < features; ++f)
                sums[f] += double{row[f]};
        }
        for (const double sum : sums)
            centre_.push_back(static_cast<float>(sum / static_cast<double>(samples.size())));
        double extent = 0;
        for (std::size_t i = 0; i < samples.size(); ++i) {
            const float* row = samples.values().data() + i * features;
            for (std::size_t f = 0; f < features; ++f)
                extent = std::max(extent, std::abs(double{row[f]} - double{centre_[f]}));
        }
        // A power of two, so that nothing is rounded by it.
        if (extent > 0)
            scale_ = static_cast<float>(std::exp2(std::clamp(-std::ceil(std::log2(extent)), -126.0, 126.0)));
    }
    static void check_products(feature_rows<> samples) {
        for (std::size_t i = 0; i < samples.size(); ++i) {
            double norm = 0;
            for (const float value : samples.row(i))
                norm += double{value} * double{value};
            if (norm > double{std::numeric_limits<float>::max()})
                detail::throw_invalid_argument({"features: row ", i,
                                                ": expected squares that add up within float, found ",
                                                std::to_string(norm), "; standardise the features"});
        }
    }

    std::vector<float> centre_;
    float scale_ = 1;
};

/// Some of the placed samples, packed for products with others.
template <svm_kernel Kernel>
class kernel_columns {
public:
    kernel_columns() = default;
    kernel_columns(const placed_rows& rows, std::span<const std::size_t> samples, float scale)
        : packed_(samples.size(), rows.original.features(),
                  [&](std::size_t i) { return rows.row(samples[i]); }),
          norms_(packed_.padded_rows()),
          scale_(scale) {
        for (std::size_t i = 0; i < samples.size(); ++i) {
            norms_[i] = rows.norm(samples[i]);
            if constexpr (Kernel::of_distance)
                originals_.push_back(rows.original.row(samples[i]).data());
        }
    }
    [[nodiscard]] std::size_t size() const { return packed_.rows(); }
    /// The length of a row of results, in whole panels.
    [[nodiscard]] std::size_t padded_size() const { return packed_.padded_rows(); }

    /// out[i][j]: product or squared distance of row `first` + i and column j. Bit-identical for a row in any
    /// batch, and for a pair of samples whichever is the row.
    void measure(const placed_rows& rows, std::size_t first, std::size_t count, float* out,
                 std::size_t stride) const {
        for (std::size_t column = 0; column < size(); column += kernels::packed_rows::panel_width)
            measure_panel(column, rows, first, count, out + column, stride);
    }
    /// The columns of one panel alone, to the beginning of `out`.
    void measure_panel(std::size_t column, const placed_rows& rows, std::size_t first, std::size_t count,
                       float* out, std::size_t stride) const {
        const std::size_t features = packed_.features();
        packed_.panel_products(column, rows.row(first), count, features, out, stride);
        if constexpr (Kernel::of_distance)
            for (std::size_t i = 0; i < count; ++i)
                to_distances(column, rows, first + i, out + i * stride);
    }

private:
    /// Pairs with a squared distance below this fraction of their norms are measured directly.
    static constexpr float close = 0x1p-6F;

    void to_distances(std::size_t column, const placed_rows& rows, std::size_t row, float* products) const {
        using v = kernels::vector<float>;
        const v own(rows.norm(row)), minus_two(-2.0F), zero(0.0F), limit(close);
        for (std::size_t j = 0; j < kernels::packed_rows::panel_width; j += kernels::lanes<float>) {
            const v both = own + kernels::load(norms_.data() + column + j);
            const v distance = kernels::multiply_add(minus_two, kernels::load(products + j), both);
            kernels::store(products + j, distance);
            if (kernels::any_of<float>(distance < limit * both))
                measure_close(column + j, rows, row, products + j);
        }
    }
    void measure_close(std::size_t column, const placed_rows& rows, std::size_t row, float* distances) const {
        const float* a = rows.original.row(row).data();
        const std::size_t end = std::min(column + kernels::lanes<float>, size());
        for (std::size_t j = column; j < end; ++j)
            if (distances[j - column] < close * (rows.norm(row) + norms_[j]))
                distances[j - column] = squared_distance(a, originals_[j]);
    }
    [[nodiscard]] float squared_distance(const float* a, const float* b) const {
        double sum = 0;
        for (std::size_t f = 0; f < packed_.features(); ++f) {
            const double d = (double{a[f]} - double{b[f]}) * double{scale_};
            sum += d * d;
        }
        return static_cast<float>(sum);
    }

    kernels::packed_rows packed_;
    aligned_vector<float> norms_;
    std::vector<const float*> originals_;
    float scale_ = 1;
};

}} // namespace tactnet
