#pragma once

#include <tactnet/detail/config.hpp>

#include <cstddef>
#include <limits>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Stops when the validation loss has not fallen below its smallest value for `patience` checks. A patience
/// of 0 never stops.
class early_stopping {
public:
    explicit early_stopping(std::size_t patience = 0) : patience_(patience) {}

    /// Adds a validation loss; returns whether to stop.
    bool check(double loss) {
        if (loss < smallest_) {
            smallest_ = loss;
            waited_ = 0;
        } else {
            ++waited_;
        }
        return patience_ > 0 && waited_ >= patience_;
    }
    void restore(double smallest, std::size_t waited) { smallest_ = smallest, waited_ = waited; }
    [[nodiscard]] double smallest() const { return smallest_; }
    [[nodiscard]] std::size_t waited() const { return waited_; }

private:
    std::size_t patience_;
    std::size_t waited_ = 0;
    double smallest_ = std::numeric_limits<double>::infinity();
};

} // namespace TACTNET_ARCH
} // namespace tactnet
