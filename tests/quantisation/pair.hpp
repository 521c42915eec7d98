#pragma once

// One filter over two inputs that go together, as a description by hand.

#include <tactnet/quantisation/graph.hpp>

#include <cstddef>
#include <vector>

namespace support {

/// Its weights, in steps of 1: with few bits, so that products with whole inputs are exact in single
/// precision. Rounded one by one they are 127 and 0, of which a sum with inputs x and 7 x loses 3.77 x; with
/// 124 and 1 it gains 0.23 x.
constexpr float first_weight = 127.375f, second_weight = 0.484375f;

/// The largest inputs of sums.
constexpr double largest_word = 32768, largest_byte = 255;

inline tactnet::detail::calibration_graph pair_description(double largest_input = largest_word) {
    tactnet::detail::calibration_graph net;
    net.ranges = 2;
    const std::size_t input = net.add_map({1, 2}, 0),
                      output = net.add_map({1, 1}, tactnet::detail::calibration_graph::none);
    static constexpr tactnet::kernels::frame_convolution sum{
        .window = {{1, 2}, tactnet::extent2d(1, 2), 1}, .filters = 1, .input_stride = 1};
    // Folded numbers follow the mean and what words hold.
    net.nodes.push_back(
        {.convolution = &sum, .largest_input = largest_input, .input = input, .output = output, .folded = 4});
    return net;
}
/// The second input is seven times the first.
inline std::vector<float> pair_images(float unit) {
    std::vector<float> images;
    for (int i = 0; i < 64; ++i) {
        const float x = unit * static_cast<float>(1 + i % 30);
        images.insert(images.end(), {x, 7 * x});
    }
    return images;
}

} // namespace support
