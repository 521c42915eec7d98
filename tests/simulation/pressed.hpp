#pragma once

#include <tactnet/simulation/contact/contact.hpp>
#include <tactnet/tensor/tensor.hpp>

#include <cmath>
#include <cstddef>
#include <limits>

// Objects and what is measured of their contact, for the tests of contact models.

namespace support {

/// `height(y, x)`, in metres from the middle of the grid.
template <tactnet::shape Shape, class Height>
tactnet::tensor<float, Shape> heights_of(double cell, const Height& height) {
    tactnet::tensor<float, Shape> result;
    for (std::size_t row = 0; row < Shape.rows; ++row)
        for (std::size_t column = 0; column < Shape.columns; ++column)
            result(row, column) = static_cast<float>(
                height((static_cast<double>(row) - (static_cast<double>(Shape.rows) - 1) / 2) * cell,
                       (static_cast<double>(column) - (static_cast<double>(Shape.columns) - 1) / 2) * cell));
    return result;
}

inline auto sphere(double radius) {
    return [=](double y, double x) { return (x * x + y * y) / (2 * radius); };
}
/// Its axis along the rows, and so x across.
inline auto cylinder(double radius) {
    return [=](double, double x) { return x * x / (2 * radius); };
}
/// A flat end without height; nothing around it.
inline auto round_punch(double radius) {
    return [=](double y, double x) {
        return std::hypot(x, y) <= radius ? 0 : std::numeric_limits<double>::infinity();
    };
}

template <tactnet::shape Shape>
double sum_of(const tactnet::tensor<float, Shape>& pressures) {
    double sum = 0;
    for (const float pressure : pressures)
        sum += static_cast<double>(pressure);
    return sum;
}
template <tactnet::shape Shape>
double peak_of(const tactnet::tensor<float, Shape>& pressures) {
    float peak = 0;
    for (const float pressure : pressures)
        peak = pressure > peak ? pressure : peak;
    return static_cast<double>(peak);
}

/// A model bound to a grid, pressed once.
template <tactnet::shape Shape>
struct pressed {
    tactnet::tensor<float, Shape> pressures;
    tactnet::simulation::contact_report report;
};
template <tactnet::shape Shape, class Model>
pressed<Shape> press(const Model& model, double cell, const tactnet::tensor<float, Shape>& heights,
                     const tactnet::simulation::pressing& how) {
    typename Model::template bound<Shape> bound(model, cell);
    pressed<Shape> result;
    result.report = bound.solve(heights.view(), how, result.pressures.view());
    return result;
}

} // namespace support
