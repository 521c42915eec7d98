#pragma once

// Three kinds of small pressure images: a spot, a bar and a ring, anywhere and of any strength, with noise.

#include <tactnet/runtime/random.hpp>
#include <tactnet/training/data/labelled_samples.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

namespace support {

struct toy_task {
    static constexpr tactnet::shape size{7, 13, 1};
    std::vector<std::uint8_t> pixels;
    std::vector<std::size_t> labels;

    explicit toy_task(std::size_t each) {
        for (std::size_t label = 0; label < 3; ++label)
            for (std::size_t i = 0; i < each; ++i) {
                tactnet::random_stream random(1, tactnet::random_purposes::order,
                                              static_cast<std::uint32_t>(label),
                                              static_cast<std::uint32_t>(i));
                const auto row = static_cast<int>(1 + random.below(5)),
                           column = static_cast<int>(2 + random.below(9));
                const auto strength = static_cast<int>(80 + random.below(170));
                for (int y = 0; y < 7; ++y)
                    for (int x = 0; x < 13; ++x) {
                        const int down = std::abs(y - row), right = std::abs(x - column);
                        const bool on = label == 0 ? down <= 1 && right <= 1
                                        : label == 1
                                            ? down == 0 && right <= 4
                                            : std::max(down, right) == 1 || (down == 0 && right == 2);
                        pixels.push_back(static_cast<std::uint8_t>(std::clamp<int>(
                            (on ? strength : 0) + static_cast<int>(random.below(8)), 0, 255)));
                    }
                labels.push_back(label);
            }
    }
    [[nodiscard]] tactnet::labelled_images images() const { return {pixels, labels, 3}; }
};

} // namespace support
