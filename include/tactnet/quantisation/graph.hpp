#pragma once

#include <tactnet/deployment/eight_bit/format.hpp>
#include <tactnet/tensor/pooling_windows.hpp>
#include <tactnet/tensor/shape.hpp>

#include <cstddef>
#include <span>
#include <vector>

// A network in 8 bits, described by numbers: what calibration does is compiled once for all networks. That of
// a network's type is made by calibration_graph_of.hpp.

namespace tactnet {
inline namespace TACTNET_ARCH {
namespace detail {

/// A map, pixel by pixel without gaps.
struct feature_map {
    shape size;
    std::size_t range; ///< which of the ranges its bytes have
    std::size_t begin; ///< its first number among those of all maps
};

/// One step. Which of the other members count, says what it does.
struct graph_node {
    /// What it makes of a map in single precision, with its folded numbers. A convolution has none:
    /// node_executor knows it. Only those that some network has are compiled.
    using function = void (*)(const graph_node& step, const float* folded, const float* in, float* out);
    function reference = nullptr;
    sliding_window window{{0, 0, 0}, 1, 1}; ///< of a convolution, or of the largest numbers
    average_windows means{};                ///< of mean numbers
    std::size_t groups = 1;                 ///< of a convolution; its window has the channels of all
    std::size_t filters = 0;                ///< of all groups
    extent2d pool = 1;                      ///< of the largest sums of a convolution
    double offset = 0;                      ///< of a root
    bool rectified = false;                 ///< of a convolution or a norm
    bool adds = false;                      ///< to the map `added`
    std::size_t input = 0, added = 0;       ///< maps
    std::size_t output = 0, first = 0;      ///< a map, and the first of its channels that is written
    shape from{}, to{};                     ///< sizes of these maps
    std::size_t folded = 0;                 ///< the first of its numbers among all folded ones
    /// Writes ranges to its folded numbers; null where it has none.
    void (*set_ranges)(float* folded, const step_ranges& ranges) = nullptr;

    /// Of a filter.
    [[nodiscard]] std::size_t taps() const { return window.input.channels / groups * window.kernel.area(); }
    [[nodiscard]] bool is_convolution() const { return reference == nullptr; }
};

/// Maps and steps in the order in which they come. Map 0 and range 0 are the frame's; outputs, which are no
/// bytes, have the range `none`.
struct calibration_graph {
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
    std::vector<feature_map> maps;
    std::vector<graph_node> nodes;
    std::size_t ranges = 1;  ///< how many there are
    std::size_t numbers = 0; ///< of all maps
    /// What makes probabilities of the numbers of a pixel at the end, where a softmax does: none of the
    /// steps.
    void (*softmax)(std::span<float> numbers) = nullptr;

    /// Returns which it is.
    [[gnu::cold]] std::size_t add_map(shape size, std::size_t range) {
        maps.push_back({size, range, numbers});
        numbers += size.size();
        return maps.size() - 1;
    }
    /// Whether bytes of any map have it.
    [[nodiscard]] bool has(std::size_t range) const {
        for (const feature_map& map : maps)
            if (map.range == range)
                return true;
        return false;
    }
    /// Writes ranges to the folded numbers of all steps, and the scales of their weights, which follow.
    [[gnu::cold]] void set_ranges(float* folded, std::span<const map_range> of_maps) const {
        const auto range = [&](std::size_t map) {
            return maps[map].range == none ? map_range{} : of_maps[maps[map].range];
        };
        for (const graph_node& step : nodes)
            if (step.set_ranges != nullptr)
                step.set_ranges(
                    folded + step.folded,
                    {range(step.input), step.adds ? range(step.added) : map_range{}, range(step.output)});
    }
};

} // namespace detail
} // namespace TACTNET_ARCH
} // namespace tactnet
