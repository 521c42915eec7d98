#pragma once

// A trunk: the layers of a network trained on photographs, up to the one whose values are features. It is
// compiled once, for the size of its photographs, which images of any size become. compile.hpp has the
// templates behind it.

#include "methods/method.hpp"

#include <tactnet/io/stored_arrays.hpp>

#include <functional>

/// How the names of a trunk's arrays begin in the file of a method that is trained on its features.
inline constexpr std::string_view trunk_prefix = "trunk.";

/// How many features a trunk's map becomes: every value, as in the paper; or, `pooled`, the largest value of
/// each channel and then the mean of each, over the image and its reflections at rows, columns and both, so
/// that features are the same for all four.
constexpr std::size_t feature_count(tactnet::shape map, bool pooled) {
    return pooled ? 2 * map.channels : map.size();
}

/// A trunk with its weights: writes a map for each photograph, [channel][row][column], the same bits in any
/// company and on any number of threads, of which any may call. Returns false for maps that are not finite.
using loaded_trunk = std::function<bool(tactnet::thread_pool& threads, std::span<const float> photographs,
                                        std::span<float> maps)>;

struct compiled_trunk {
    photograph_network network;
    std::string_view features; ///< the layer it ends in, as the paper's authors have it: "fire9-concat"
    /// How the names of arrays after the trunk begin, which a file may hold or not.
    std::vector<std::string> behind;
    tactnet::shape photograph, map;
    method_costs costs; ///< of one photograph

    /// By torchvision's names.
    tactnet::stored_arrays (*arrays)();
    /// Reads the arrays, whose names begin with `prefix`. Throws tactnet::file_error.
    loaded_trunk (*load)(const compiled_trunk& trunk, tactnet::safetensors_source& file,
                         std::string_view prefix);
    /// With random weights of the usual size, for timing.
    loaded_trunk (*seeded)();
};
