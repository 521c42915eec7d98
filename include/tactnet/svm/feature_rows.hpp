#pragma once

#include <tactnet/tensor/tensor_view.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
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

}} // namespace tactnet
