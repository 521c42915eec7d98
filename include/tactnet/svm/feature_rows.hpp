#pragma once

#include <tactnet/tensor/tensor.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// For a number of features that is only known at run time.
inline constexpr std::size_t dynamic_features = std::dynamic_extent;

/// A view of samples that belong to the caller: a row of float features per sample, one after the other.
template <std::size_t Features = dynamic_features>
class feature_rows {
public:
    static_assert(Features > 0, "a sample has at least one feature");

    /// Throws std::invalid_argument unless the values are a whole number of rows.
    explicit feature_rows(std::span<const float> values)
        requires(Features != dynamic_features)
        : feature_rows(values, Features) {}
    feature_rows(std::span<const float> values, std::size_t features) : values_(values), features_(features) {
        if ((Features != dynamic_features && features != Features) || features == 0 ||
            values.size() % features != 0)
            detail::throw_invalid_argument(
                {"rows of features: expected ",
                 Features == dynamic_features ? std::string("one or more") : std::to_string(Features),
                 " features in whole rows, found ", values.size(), " values in rows of ", features});
    }
    template <class Values>
        requires(!borrowed_range<Values> && std::is_constructible_v<std::span<const float>, Values>)
    explicit feature_rows(Values&&, std::size_t = Features) = delete; // values of a temporary: give it a name
    /// As rows of any number of features.
    operator feature_rows<dynamic_features>() const
        requires(Features != dynamic_features)
    {
        return {values_, features_};
    }

    /// The number of rows.
    [[nodiscard]] std::size_t size() const { return values_.size() / features(); }
    [[nodiscard]] constexpr std::size_t features() const {
        return Features == dynamic_features ? features_ : Features;
    }
    [[nodiscard]] std::span<const float> values() const { return values_; }
    [[nodiscard]] std::span<const float, Features> row(std::size_t index) const {
        return std::span<const float, Features>(values_.data() + index * features(), features());
    }

private:
    std::span<const float> values_;
    std::size_t features_;
};

/// Throws std::invalid_argument, naming row and column, when a feature is not a finite number.
inline void check_finite(feature_rows<> rows) {
    const std::span<const float> values = rows.values();
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i]))
            detail::throw_invalid_argument({"features: row ", i / rows.features(), ", column ",
                                            i % rows.features(), ": expected a finite number, found ",
                                            std::to_string(values[i])});
}

/// 0 … count − 1: the samples of all rows.
[[nodiscard]] inline std::vector<std::size_t> all_samples(std::size_t count) {
    std::vector<std::size_t> samples(count);
    std::iota(samples.begin(), samples.end(), std::size_t{0});
    return samples;
}

/// Throws std::invalid_argument unless all features are finite and there is a label for each row.
inline void check_samples(feature_rows<> rows, std::span<const std::size_t> labels) {
    if (labels.size() != rows.size())
        detail::throw_invalid_argument(
            {"labels: expected ", rows.size(), ", one for each row, found ", labels.size()});
    check_finite(rows);
}

namespace detail {

/// Calls take(rows) for one block of rows after the other, so that temporary memory does not grow with their
/// number. `bytes_each` is the temporary memory of a row. A block takes at most 16 MiB, but has at least one
/// row.
template <std::size_t Features, class Take>
void for_each_block(feature_rows<Features> rows, std::size_t bytes_each, const Take& take) {
    constexpr std::size_t max_bytes = std::size_t{1} << 24U;
    const std::size_t most = std::max<std::size_t>(1, max_bytes / std::max<std::size_t>(1, bytes_each));
    for (std::size_t first = 0; first < rows.size(); first += most) {
        const std::size_t count = std::min(most, rows.size() - first);
        take(feature_rows<Features>(rows.values().subspan(first * rows.features(), count * rows.features()),
                                    rows.features()));
    }
}

} // namespace detail

/// Subtracts the mean of each feature and divides by its standard deviation, both of the training set. A
/// feature that is constant there is only centred.
struct standardisation {
    std::vector<float> mean;
    std::vector<float> deviation; ///< 1 for a constant feature

    /// Means and deviations (divided by the count) in double. Throws std::invalid_argument without rows.
    [[nodiscard]] static standardisation of(feature_rows<> rows) {
        if (rows.size() == 0)
            throw std::invalid_argument("standardisation: expected one row or more, found none");
        const std::size_t features = rows.features();
        const double count = static_cast<double>(rows.size());
        std::vector<double> sums(features), squares(features);
        const auto each = [&](auto&& body) {
            for (std::size_t i = 0; i < rows.size(); ++i)
                for (std::size_t f = 0; f < features; ++f)
                    body(f, double{rows.values()[i * features + f]});
        };
        each([&](std::size_t f, double value) { sums[f] += value / count; });
        each([&](std::size_t f, double value) {
            squares[f] += (value - sums[f]) * (value - sums[f]) / count;
        });
        standardisation result;
        for (std::size_t f = 0; f < features; ++f) {
            // A deviation within the rounding error of a constant counts as zero.
            const double deviation = std::sqrt(squares[f]);
            const double noise = std::numeric_limits<double>::epsilon() * count * std::abs(sums[f]);
            const float single = static_cast<float>(deviation);
            result.mean.push_back(static_cast<float>(sums[f]));
            result.deviation.push_back(deviation > noise && single > 0 ? single : 1.0F);
        }
        return result;
    }

    /// Returns the standardised rows, one after the other. Throws std::invalid_argument for another number of
    /// features.
    [[nodiscard]] std::vector<float> apply(feature_rows<> rows) const {
        const std::size_t features = rows.features();
        if (features != mean.size())
            detail::throw_invalid_argument(
                {"standardisation: expected ", mean.size(), " features, found ", features});
        std::vector<float> result(rows.values().size());
        for (std::size_t i = 0; i < rows.size(); ++i)
            for (std::size_t f = 0; f < features; ++f)
                result[i * features + f] = (rows.values()[i * features + f] - mean[f]) / deviation[f];
        return result;
    }
};

/// The standardisation of a training set if it is wanted, else none.
[[nodiscard]] inline std::optional<standardisation> fit_standardisation(feature_rows<> rows, bool wanted) {
    return wanted ? std::optional(standardisation::of(rows)) : std::nullopt;
}

/// Rows as a machine sees them: standardised, or as they are if there is no standardisation.
class standardised_rows {
public:
    /// The rows must outlive this.
    standardised_rows(feature_rows<> rows, const std::optional<standardisation>& fitted)
        : values_(fitted ? fitted->apply(rows) : std::vector<float>()),
          rows_(fitted ? feature_rows<>(values_, rows.features()) : rows) {}
    // rows_ may refer to values_.
    standardised_rows(const standardised_rows&) = delete;
    standardised_rows& operator=(const standardised_rows&) = delete;

    [[nodiscard]] feature_rows<> rows() const { return rows_; }

private:
    std::vector<float> values_;
    feature_rows<> rows_;
};

}} // namespace tactnet
