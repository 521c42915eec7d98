#pragma once

#include <tactnet/kernels/rows/packed.hpp>
#include <tactnet/text/message.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

// Points of some numbers each, one after the other: whether they can be compared, and which of them is
// nearest.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// Checks that `points` holds one or more points of `values` numbers whose squared distances stay finite in
/// single precision. If not, throws std::invalid_argument, which begins with the name of the caller and names
/// the first number that is NaN, infinite or larger than 10¹⁷.
inline void check_points(const char* caller, std::span<const float> points, std::size_t values) {
    if (points.empty() || points.size() % values != 0)
        throw_invalid_argument(
            {caller, ": expected points of ", values, " numbers each, found ", points.size(), " numbers"});
    const auto broken =
        std::find_if_not(points.begin(), points.end(), [](float v) { return std::abs(v) <= 1e17f; });
    if (broken == points.end())
        return;
    const auto place = static_cast<std::size_t>(broken - points.begin());
    throw_invalid_argument({caller, ": expected finite numbers of at most 1e17, found ",
                            std::to_string(*broken), " as number ", place % values, " of point ",
                            place / values, " (counted from 0)"});
}

/// Returns the mean of points of `Values` numbers if it is far from zero compared with their extent, and
/// nothing if it is near. A search by ‖c‖² − 2 c·x loses the distances of far points to rounding unless their
/// mean is subtracted first.
template <std::size_t Values>
[[nodiscard]] std::vector<double> far_origin(std::span<const float> points) {
    constexpr double far = 32; // deviations; nearer, 1/1000 of the squares remains
    const double count = static_cast<double>(points.size() / Values);
    std::array<double, Values> middle{};
    double extent = 0, offset = 0;
    for (std::size_t e = 0; e < points.size(); ++e)
        middle[e % Values] += static_cast<double>(points[e]) / count;
    for (std::size_t e = 0; e < points.size(); ++e) {
        const double d = static_cast<double>(points[e]) - middle[e % Values];
        extent += d * d / count;
    }
    for (const double m : middle)
        offset += m * m;
    if (offset > far * far * extent)
        return {middle.begin(), middle.end()};
    return {};
}

/// Finds the nearest of some rows of `Values` numbers to each point. An origin, which is subtracted from rows
/// and points, may be empty. Safe to share between threads.
template <std::size_t Values>
class nearest_point {
public:
    nearest_point(std::span<const float> rows, std::vector<double> origin)
        : origin_(std::move(origin)), search_(moved(rows)) {}

    /// Writes the index of a row for each point. Uses no heap.
    void find(std::span<const float> points, std::uint32_t* nearest) const noexcept {
        if (origin_.empty())
            return search_.find(points.data(), points.size() / Values, nearest);
        constexpr std::size_t group = kernels::nearest_row<Values>::group;
        std::array<float, group * Values> near_zero;
        for (; !points.empty(); nearest += group) {
            const std::size_t size = std::min(near_zero.size(), points.size());
            for (std::size_t e = 0; e < size; ++e)
                near_zero[e] = moved(points[e], e);
            search_.find(near_zero.data(), size / Values, nearest);
            points = points.subspan(size);
        }
    }

private:
    /// Subtracts the origin from element `place` of rows or points.
    [[nodiscard]] float moved(float number, std::size_t place) const noexcept {
        return static_cast<float>(static_cast<double>(number) - origin_[place % Values]);
    }
    [[nodiscard]] std::vector<float> moved(std::span<const float> rows) const {
        std::vector<float> result(rows.begin(), rows.end());
        for (std::size_t e = 0; !origin_.empty() && e < result.size(); ++e)
            result[e] = moved(result[e], e);
        return result;
    }

    std::vector<double> origin_;
    kernels::nearest_row<Values> search_;
};

}}} // namespace tactnet::detail
