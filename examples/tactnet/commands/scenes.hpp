#pragma once

// Scenes that the program can simulate. What an effect costs is paid when a scene is compiled, so that the
// program names a few and knows no more of them than this.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

struct simulated_image {
    std::vector<std::uint8_t> counts; ///< row by row
    bool settled = true;              ///< whether the contact was found
};

/// A scene at work, for one thread: touch `number` of a class, which is an index of
/// simulation::paper_objects; the same bits wherever it is made.
using simulator = std::function<simulated_image(std::size_t label, std::uint64_t seed, std::uint32_t number)>;

struct simulated_scene {
    std::string_view name, says;
    std::size_t rows, columns;
    simulator (*make)();
};

std::span<const simulated_scene> simulated_scenes();
