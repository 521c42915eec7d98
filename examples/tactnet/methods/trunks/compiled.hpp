#pragma once

// A trunk: the layers of a network trained on photographs, up to the one whose values are features. It is
// compiled once, for the size of its photographs, which images of any size become. compile.hpp has the
// templates behind it.

#include "methods/method.hpp"
#include "methods/networks/compiled.hpp"

#include <tactnet/io/safetensors/source.hpp>
#include <tactnet/io/stored_arrays.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/shape.hpp>

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

/// How the names of a trunk's arrays begin in the file of a method that is trained on its features.
inline constexpr std::string_view trunk_prefix = "trunk.";

enum class trunk_pooling {
    none,  ///< every value, as in the paper
    pooled ///< the largest value of each channel, then the mean of each channel
};

/// What of a trunk's map becomes features.
struct trunk_features_form {
    trunk_pooling pooling = trunk_pooling::none;
    /// Whether an image stands for its reflections, too, at rows, columns and both: the largest values are
    /// those of all four, and the means are means of all four, so that features are the same for all four.
    bool reflected = false;

    constexpr std::size_t size(tactnet::shape map) const {
        return pooling == trunk_pooling::none ? map.size() : 2 * map.channels;
    }
    /// Photographs of one image.
    constexpr std::size_t views() const { return reflected ? 4 : 1; }
};

/// A trunk with its weights, in its fastest form: writes a map for each photograph, one after the other, all
/// [channel][row][column]; the same bits in any company and on any number of threads. Returns false for maps
/// that are not finite. Calls may come from any number of threads.
using loaded_trunk = std::function<bool(tactnet::thread_pool& threads, std::span<const float> photographs,
                                        std::span<float> maps)>;

struct compiled_trunk {
    photograph_network network;
    std::string_view features; ///< the layer it ends in, as the paper's authors have it: "fire9-concat"
    /// How the names of arrays after the trunk begin, which a file may hold or not.
    std::vector<std::string> behind;
    tactnet::shape photograph, map;
    method_costs costs; ///< of one photograph

    std::string_view head_method; ///< the method that trains a head on it: "squeezenet-pooled-nn"
    trunk_features_form head_features;
    compiled_network head; ///< of features; it is never deployed

    /// By torchvision's names.
    tactnet::stored_arrays (*arrays)();
    /// Reads the arrays, whose names begin with `prefix`. Throws tactnet::file_error.
    loaded_trunk (*load)(const compiled_trunk& trunk, tactnet::safetensors_source& file,
                         std::string_view prefix);
    /// With random weights of the usual size, for timing.
    loaded_trunk (*seeded)();
};
