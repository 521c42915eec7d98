#pragma once

#include <tactnet/kernels/simd/special_functions.hpp>
#include <tactnet/svm/feature_rows.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <concepts>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <string_view>

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

}} // namespace tactnet
