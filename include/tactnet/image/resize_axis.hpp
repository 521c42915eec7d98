#pragma once

#include <tactnet/image/resize_kernel.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

// The taps of every output along one direction: a compile-time constant where sizes are, else made once a
// call. An input that an output weighs by zero is no tap of it: if it is not a number, the output still is.

namespace tactnet {
inline namespace TACTNET_ARCH {

namespace detail {

/// Inputs first … first + count − 1 and their weights, which sum to one.
template <class Weights>
struct resize_taps {
    std::size_t first = 0, count = 0;
    Weights weights{};

    /// Calls body(input, weight) for each tap of weight other than zero.
    template <class Body>
    constexpr void for_each(Body&& body) const {
        for (std::size_t t = 0; t < count; ++t)
            if (weights[t] != 0)
                body(first + t, weights[t]);
    }
};

/// The most taps that an output can have.
[[nodiscard]] constexpr std::size_t most_taps(std::size_t from, std::size_t to) {
    return std::min(from, (from > to ? 4 * ((from + to - 1) / to) : 4) + 2);
}

/// The taps of one output. `weights` has room for most_taps numbers, all zero.
template <class Kernel, class Weights>
constexpr void find_taps(std::size_t output, std::size_t from, std::size_t to, resize_taps<Weights>& taps) {
    // One rounding, so that whole coordinates are whole.
    const double centre = (static_cast<double>((2 * output + 1) * from) - static_cast<double>(to)) /
                          static_cast<double>(2 * to);
    const double scale = static_cast<double>(to) / static_cast<double>(from);
    std::size_t first = from, last = 0;
    double sum = 0;
    Kernel::taps(centre, scale, from, [&](std::size_t input, double weight) {
        first = std::min(first, input);
        last = std::max(last, input);
        sum += weight;
    });
    Kernel::taps(centre, scale, from,
                 [&](std::size_t input, double weight) { taps.weights[input - first] += weight / sum; });
    taps.first = first;
    taps.count = last + 1 - first;
}

} // namespace detail

/// The taps of all outputs, a compile-time constant, in single precision.
template <class Kernel, std::size_t From, std::size_t To>
struct resize_axis {
    static constexpr std::size_t inputs = From, outputs = To;

private:
    using weights = std::array<double, detail::most_taps(From, To)>;
    static constexpr auto exact = [] {
        std::array<detail::resize_taps<weights>, To> all{};
        for (std::size_t o = 0; o < To; ++o)
            detail::find_taps<Kernel>(o, From, To, all[o]);
        return all;
    }();

public:
    /// Taps of every output: the largest count. Outputs with fewer have weights of zero among theirs.
    static constexpr std::size_t taps = [] {
        std::size_t most = 0;
        for (const auto& each : exact)
            most = std::max(most, each.count);
        return most;
    }();

    struct output {
        std::size_t first;
        std::array<float, taps> weights;
    };
    static constexpr std::array<output, To> table = [] {
        std::array<output, To> all{};
        for (std::size_t o = 0; o < To; ++o) {
            all[o].first = std::min(exact[o].first, From - taps);
            for (std::size_t t = 0; t < exact[o].count; ++t)
                all[o].weights[exact[o].first + t - all[o].first] = static_cast<float>(exact[o].weights[t]);
        }
        return all;
    }();
    /// Whether some weight is zero.
    static constexpr bool has_gaps = [] {
        for (const output& each : table)
            for (const float weight : each.weights)
                if (weight == 0)
                    return true;
        return false;
    }();
};

/// The same for sizes known only when running, in double precision.
template <class Kernel>
class dynamic_axis {
public:
    using output = detail::resize_taps<std::vector<double>>;

    dynamic_axis(std::size_t from, std::size_t to) : table_(to) {
        for (std::size_t o = 0; o < to; ++o) {
            table_[o].weights.resize(detail::most_taps(from, to));
            detail::find_taps<Kernel>(o, from, to, table_[o]);
        }
    }
    [[nodiscard]] const output& operator[](std::size_t index) const { return table_[index]; }
    [[nodiscard]] std::size_t size() const { return table_.size(); }

private:
    std::vector<output> table_;
};

} // namespace TACTNET_ARCH
} // namespace tactnet
