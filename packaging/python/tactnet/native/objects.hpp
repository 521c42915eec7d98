#pragma once

// Of known and unknown objects: the map of features, and the means of classes.

#include "interface.hpp"

#include <tactnet/decision/discriminant.hpp>

#include <algorithm>
#include <optional>

namespace tactnet_python {

/// What is learnt, as bytes.
class with_state {
public:
    virtual ~with_state() = default;
    virtual std::vector<std::byte> state() const = 0;
    virtual tactnet::restore_status restore(std::span<const std::byte> state) = 0;
};

/// A discriminant of any size: zeros until it is fitted or restored.
class any_discriminant : public with_state {
public:
    virtual void fit(std::span<const float> rows, std::span<const std::size_t> labels, std::size_t classes,
                     double shrinkage) = 0;
    virtual void project(std::span<const float> row, std::span<float> to) const = 0;
    std::size_t features = 0, dimensions = 0;
};

/// Class means of any size.
class any_means : public with_state {
public:
    virtual bool learn(std::size_t index, std::span<const float> touch) = 0;
    virtual void forget(std::size_t index) = 0;
    virtual std::size_t touches(std::size_t index) const = 0;
    virtual double spread(std::size_t index) const = 0;
    virtual std::optional<tactnet::nearest_class> nearest(std::span<const float> touch) const = 0;
    std::size_t dimensions = 0, most_classes = 0;
};

} // namespace tactnet_python
