#include "scenes.hpp"

#include <tactnet/simulation/paper_scene.hpp>
#include <tactnet/simulation/simulate.hpp>

#include <algorithm>
#include <array>

namespace {

template <class Scene>
simulated_image image(std::size_t family, std::uint64_t seed, std::uint32_t number) {
    const auto frames = tactnet::simulation::simulate_paper_touch<Scene>(family, seed, number);
    simulated_image result{std::vector<std::uint8_t>(Scene::output.size()), frames.contact.converged};
    std::ranges::transform(frames.measured, result.counts.begin(),
                           [](float count) { return static_cast<std::uint8_t>(count); });
    return result;
}

template <class Scene>
constexpr simulated_scene named(std::string_view name, std::string_view says) {
    return {name, says, Scene::output.rows, Scene::output.columns, &image<Scene>};
}

} // namespace

std::span<const simulated_scene> simulated_scenes() {
    using namespace tactnet::simulation;
    static constexpr std::array list{
        named<paper_scene>("paper", "as the paper's sensor and files show it"),
        named<ideal_scene>("ideal", "as an array without faults would"),
    };
    return list;
}
