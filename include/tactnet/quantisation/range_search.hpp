#pragma once

#include <tactnet/quantisation/activation_observer.hpp>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// Searches the range of each map: the fraction of the observed range with which the outputs in 8 bits come
/// closest to the outputs in single precision, map by map, the ranges of the others fixed.
class range_search {
public:
    /// The largest first, so that it wins ties. Rounding errors grow with the range: 0.95 of it saves a
    /// twentieth of them, one half as much as a further bit. Chosen, finer near 1 since clipping soon costs
    /// more than that saves. Measured with the authors' TactNet-4 at 14 × 25, calibrated on four fifths of
    /// 110 images, five times: the error of outputs with rounded weights is 0.1598, with full ranges 0.1612.
    /// Maps with outliers gain most.
    static constexpr std::array fractions{1.0, 0.95, 0.9, 0.85, 0.8, 0.7, 0.6, 0.5};
    /// The second sweep searches each range again beside the ranges found by the first. Measured as above:
    /// none of the five networks changed in it, nor in a third.
    static constexpr int sweeps = 2;

    /// Writes the ranges, and the scales that follow from them, to the folded numbers of the network, which
    /// begin with the mean and the steps per count of the words.
    [[gnu::cold]] range_search(const calibration_graph& net, const activation_observer& seen, float scale,
                               run_quantised recognise, std::span<float> folded)
        : net_(net), seen_(seen), scale_(scale), folded_(folded) {
        std::vector<double> of_full(net.ranges, fractions.front());
        set_ranges(of_full);
        error_ = seen.error_of(recognise, folded);
        for (int sweep = 0; sweep < sweeps; ++sweep)
            for (std::size_t m = 1; m < net.ranges; ++m) {
                if (!net.has(m))
                    continue;
                double best = of_full[m];
                for (const double fraction : fractions) {
                    of_full[m] = fraction;
                    set_ranges(of_full);
                    if (const double error = seen.error_of(recognise, folded); error < error_)
                        error_ = error, best = fraction;
                }
                of_full[m] = best;
            }
        set_ranges(of_full);
    }
    /// The range of the words first.
    [[nodiscard]] std::span<const map_range> ranges() const { return ranges_; }
    /// The mean squared error of the outputs with these ranges.
    [[nodiscard]] double error() const { return error_; }

private:
    [[gnu::cold]] void set_ranges(const std::vector<double>& of_full) {
        ranges_ = std::vector<map_range>(net_.ranges);
        ranges_[0] = {scale_ / folded_[net_.maps[0].size.size()], 0};
        for (std::size_t m = 1; m < net_.ranges; ++m)
            ranges_[m] = map_range::of(seen_.lowest(m) * of_full[m], seen_.highest(m) * of_full[m]);
        net_.set_ranges(folded_.data(), ranges_);
    }

    const calibration_graph& net_;
    const activation_observer& seen_;
    float scale_;
    std::span<float> folded_;
    std::vector<map_range> ranges_;
    double error_ = 0;
};

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet
