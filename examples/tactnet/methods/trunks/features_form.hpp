#pragma once

// What of a trunk's map becomes features.

#include <tactnet/io/safetensors/header.hpp>
#include <tactnet/tensor/shape.hpp>

#include <cstddef>

enum class trunk_pooling {
    none,  ///< every value, as in the paper
    pooled ///< the largest value of each channel, then the mean of each channel
};

struct trunk_features_form {
    trunk_pooling pooling = trunk_pooling::none;
    /// Whether an image stands for its reflections, too, at rows, columns and both: the largest values are
    /// those of all four, and the means are means of all four, so that features do not tell them apart.
    bool reflected = false;

    constexpr std::size_t size(tactnet::shape map) const {
        return pooling == trunk_pooling::none ? map.size() : 2 * map.channels;
    }
    /// Photographs of one image.
    constexpr std::size_t views() const { return reflected ? 4 : 1; }
    tactnet::file_metadata describe() const;
};
