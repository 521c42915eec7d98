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

    /// Samples of a class, and samples recognised as it.
    [[nodiscard]] std::size_t samples(std::size_t truth) const {
        std::size_t sum = 0;
        for (std::size_t c = 0; c < classes_; ++c)
            sum += count(truth, c);
        return sum;
    }
    [[nodiscard]] std::size_t recognised(std::size_t label) const {
        std::size_t sum = 0;
        for (std::size_t c = 0; c < classes_; ++c)
            sum += count(c, label);
        return sum;
    }
    /// Share of a class's samples that are recognised; NaN without any.
    [[nodiscard]] double recall(std::size_t label) const { return share(label, samples(label)); }
    /// Share of right ones among all that are recognised as a class; NaN without any.
    [[nodiscard]] double precision(std::size_t label) const { return share(label, recognised(label)); }
    /// Harmonic mean of both: 2 right / (samples + recognised); NaN for a class without either.
    [[nodiscard]] double f1(std::size_t label) const {
        return 2 * share(label, samples(label) + recognised(label));
    }
    /// Mean recall of the classes that have samples: the accuracy if all had equally many. NaN without any.
    [[nodiscard]] double balanced_accuracy() const { return mean_over_classes(&confusion_matrix::recall); }
    /// Mean F1 of the classes that have samples or are recognised; NaN without any.
    [[nodiscard]] double macro_f1() const { return mean_over_classes(&confusion_matrix::f1); }

private:
    [[nodiscard]] double share(std::size_t label, std::size_t of) const {
        return of > 0 ? static_cast<double>(count(label, label)) / static_cast<double>(of)
                      : std::numeric_limits<double>::quiet_NaN();
    }
    [[nodiscard]] double mean_over_classes(double (confusion_matrix::*value)(std::size_t) const) const {
        double sum = 0;
        std::size_t known = 0;
        for (std::size_t c = 0; c < classes_; ++c)
            if (const double of_class = (this->*value)(c); !std::isnan(of_class))
                sum += of_class, ++known;
        return known > 0 ? sum / static_cast<double>(known) : std::numeric_limits<double>::quiet_NaN();
    }

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
