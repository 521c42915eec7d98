#pragma once

#include <tactnet/detail/config.hpp>

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Counts of (true class, recognised class).
class confusion_matrix {
public:
    explicit confusion_matrix(std::size_t classes = 0) : classes_(classes), counts_(classes * classes) {}

    void add(std::size_t truth, std::size_t recognised) { ++counts_[truth * classes_ + recognised]; }
    void add(const confusion_matrix& other) {
        for (std::size_t i = 0; i < counts_.size(); ++i)
            counts_[i] += other.counts_[i];
    }
    [[nodiscard]] std::size_t classes() const { return classes_; }
    /// How many samples of class `truth` were recognised as another class, or as their own.
    [[nodiscard]] std::size_t count(std::size_t truth, std::size_t recognised) const {
        return counts_[truth * classes_ + recognised];
    }
    [[nodiscard]] std::size_t total() const {
        std::size_t sum = 0;
        for (const std::size_t n : counts_)
            sum += n;
        return sum;
    }
    [[nodiscard]] std::size_t correct() const {
        std::size_t sum = 0;
        for (std::size_t c = 0; c < classes_; ++c)
            sum += count(c, c);
        return sum;
    }
    /// Share of the diagonal; NaN without samples.
    [[nodiscard]] double accuracy() const {
        return total() > 0 ? static_cast<double>(correct()) / static_cast<double>(total())
                           : std::numeric_limits<double>::quiet_NaN();
    }

private:
    std::size_t classes_;
    std::vector<std::size_t> counts_;
};

/// Mean and sample standard deviation (n − 1).
struct mean_and_deviation {
    double mean = 0, deviation = 0;

    [[nodiscard]] static mean_and_deviation of(std::span<const double> values) {
        mean_and_deviation m;
        if (values.empty())
            return m;
        for (const double v : values) // divided at the end: the mean of equal numbers is that number
            m.mean += v;
        m.mean /= static_cast<double>(values.size());
        for (const double v : values)
            m.deviation += (v - m.mean) * (v - m.mean);
        m.deviation = values.size() > 1 ? std::sqrt(m.deviation / static_cast<double>(values.size() - 1)) : 0;
        return m;
    }
};

}} // namespace tactnet
