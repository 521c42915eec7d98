#pragma once

#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/tensor/pooling_windows.hpp>
#include <tactnet/tensor/shape.hpp>

#include <cstddef>
#include <span>
#include <vector>

// A network in 8 bits as a graph of numbers, so that calibration is compiled once for all networks.
// graph_of.hpp makes the graph of a network's type.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

/// A feature map, pixel by pixel without gaps.
struct feature_map {
    shape size;
    std::size_t range; ///< the index of the range of its bytes
    std::size_t begin; ///< its first number among the numbers of all maps
};

/// One step. Which of the other members count depends on its operator.
struct graph_node {
    /// The operator in single precision, with its folded numbers. Convolutions and products have none:
    /// node_executor computes them. Only operators that some network has are compiled.
    using function = void (*)(const graph_node& step, const float* folded, const float* in, float* out);
    function reference = nullptr;
    sliding_window window{{0, 0, 0}, 1, 1}; ///< of a convolution or a max pool
    pooling_windows means{};                ///< of an average pool
    std::size_t groups = 1;                 ///< of a convolution; its window has the channels of all
    std::size_t filters = 0;                ///< of all groups
    extent2d pool = 1;                      ///< a max pool fused with a convolution
    double offset = 0;                      ///< of a square root
    bool relu = false;                      ///< of a convolution or a norm
    bool accumulates = false;               ///< to the map `added`
    bool multiplies = false;                ///< the input by the factors in the map `added`
    std::size_t input = 0, added = 0;       ///< maps
    std::size_t output = 0, first = 0;      ///< a map, and the first of its channels that is written
    shape from{}, to{};                     ///< sizes of these maps
    std::size_t folded = 0;                 ///< the first of its folded numbers
    /// Writes ranges to its folded numbers; null where it has none.
    void (*set_ranges)(float* folded, const step_ranges& ranges) = nullptr;

    /// The weights of one filter.
    [[nodiscard]] std::size_t taps() const { return window.input.channels / groups * window.kernel.area(); }
    [[nodiscard]] bool is_convolution() const { return reference == nullptr && !multiplies; }
    /// Whether it reads the map `added`, too.
    [[nodiscard]] bool reads_added() const { return accumulates || multiplies; }
};

/// Maps and steps in the order of execution. Map 0 and range 0 belong to the frame. The outputs, which are
/// not bytes, have the range `none`.
struct calibration_graph {
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
    std::vector<feature_map> maps;
    std::vector<graph_node> nodes;
    std::size_t ranges = 1;  ///< how many there are
    std::size_t numbers = 0; ///< of all maps
    /// The softmax over the channels of a pixel at the end of the network, or null.
    void (*softmax)(std::span<float> numbers) = nullptr;

    /// Appends a map and returns its index.
    [[gnu::cold]] std::size_t add_map(shape size, std::size_t range) {
        maps.push_back({size, range, numbers});
        numbers += size.size();
        return maps.size() - 1;
    }
    /// Whether any map has this range.
    [[nodiscard]] bool has(std::size_t range) const {
        for (const feature_map& map : maps)
            if (map.range == range)
                return true;
        return false;
    }
    /// Writes ranges, and the scales of weights that follow from them, to the folded numbers of all steps.
    [[gnu::cold]] void set_ranges(float* folded, std::span<const map_range> of_maps) const {
        const auto range = [&](std::size_t map) {
            return maps[map].range == none ? map_range{} : of_maps[maps[map].range];
        };
        for (const graph_node& step : nodes)
            if (step.set_ranges != nullptr)
                step.set_ranges(folded + step.folded,
                                {range(step.input), step.reads_added() ? range(step.added) : map_range{},
                                 range(step.output)});
    }
};

}}} // namespace tactnet::detail
