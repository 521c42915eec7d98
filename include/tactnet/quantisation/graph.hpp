#pragma once

#include <tactnet/kernels/frame_convolution.hpp>
#include <tactnet/lowering/eight_bit_format.hpp>
#include <tactnet/tensor/shape.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
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

/// One step: a convolution or a dense layer, whose weights calibration rounds, or a function.
struct graph_node {
    static constexpr std::size_t none = static_cast<std::size_t>(-1);
    /// The step in single precision, with its folded numbers: writes `out`, which may be `in`.
    using function = void (*)(const float* folded, const float* in, const float* added, float* out);

    const kernels::frame_convolution* convolution = nullptr; ///< null for a function
    double largest_input = 0;                                ///< of a convolution, in steps of its input
    function reference = nullptr;
    std::size_t input = 0, added = none, output = 0; ///< maps; it need not read `added`
    std::size_t folded = 0;                          ///< the first of its folded numbers
    /// Writes ranges to its folded numbers; null where it has none.
    void (*set_ranges)(float* folded, const step_ranges& ranges) = nullptr;
};

/// Maps and steps in the order of execution. Map 0 and range 0 belong to the frame. The outputs, which are
/// not bytes, have the range `none`.
struct calibration_graph {
    static constexpr std::size_t none = graph_node::none;
    std::vector<feature_map> maps;
    std::vector<graph_node> nodes;
    std::size_t ranges = 1; ///< how many there are
    /// Those that steps give themselves.
    std::vector<std::pair<std::size_t, map_range>> given{};
    std::size_t numbers = 0; ///< of all maps

    /// Appends a map and returns its index.
    [[gnu::cold]] std::size_t add_map(shape size, std::size_t range) {
        maps.push_back({size, range, numbers});
        numbers += size.size();
        return maps.size() - 1;
    }
    /// A map among the numbers of all maps; null for none.
    template <class T>
    [[nodiscard]] T* map(T* numbers_of_maps, std::size_t which) const {
        return which == none ? nullptr : numbers_of_maps + maps[which].begin;
    }
    /// Whether any map has this range.
    [[nodiscard]] bool has(std::size_t range) const {
        for (const feature_map& map : maps)
            if (map.range == range)
                return true;
        return false;
    }
    /// The range of a map, or (1, 0) if it has none.
    [[nodiscard]] map_range range_of(std::size_t map, std::span<const map_range> of_maps) const {
        if (map == none || maps[map].range == none)
            return {};
        for (const auto& [range, value] : given)
            if (range == maps[map].range)
                return value;
        return of_maps[maps[map].range];
    }
    /// The index of each range that calibration finds, and the index of its step in the order of folded
    /// numbers.
    [[nodiscard]] [[gnu::cold]] std::vector<std::pair<std::size_t, std::size_t>> observed_ranges() const {
        std::vector<std::pair<std::size_t, std::size_t>> found;
        for (const graph_node& node : nodes) {
            const std::size_t range = maps[node.output].range;
            const auto before = [&](const graph_node& other) { return other.folded < node.folded; };
            const auto is_range = [&](const auto& one) { return one.first == range; };
            if (range != none && range != maps[node.input].range &&
                std::none_of(given.begin(), given.end(), is_range))
                found.emplace_back(range, std::count_if(nodes.begin(), nodes.end(), before));
        }
        return found;
    }
    /// The ranges of the maps of a step.
    [[nodiscard]] step_ranges ranges_of(const graph_node& step, std::span<const map_range> of_maps) const {
        return {range_of(step.input, of_maps), range_of(step.added, of_maps), range_of(step.output, of_maps)};
    }
    /// Writes ranges, and the scales of weights that follow from them, to the folded numbers of all steps.
    [[gnu::cold]] void set_ranges(float* folded, std::span<const map_range> of_maps) const {
        for (const graph_node& step : nodes)
            if (step.set_ranges != nullptr)
                step.set_ranges(folded + step.folded, ranges_of(step, of_maps));
    }
};

}}} // namespace tactnet::detail
