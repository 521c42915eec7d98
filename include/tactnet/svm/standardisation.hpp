#pragma once

#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/text/message.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

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
