#include "commands/scenes.hpp"

#include <tactnet/simulation/contact/elastic.hpp>
#include <tactnet/simulation/paper/objects.hpp>

#include <array>
#include <memory>

namespace {

template <class Scene>
simulator simulator_of(Scene scene) {
    const auto own = std::make_shared<Scene>(std::move(scene));
    const auto frames = std::make_shared<typename Scene::frames>();
    return [own, frames](std::size_t label, std::uint64_t seed, std::uint32_t number) -> simulated_image {
        tactnet::simulation::simulate_paper_touch(*own, label, seed, number, *frames);
        const auto& counts = frames->measured; // whole numbers of 8 bits
        return {{counts.begin(), counts.end()}, frames->contact.converged};
    };
}

template <class Scene>
constexpr simulated_scene named(std::string_view name, std::string_view says) {
    return {name, says, Scene::output.rows, Scene::output.columns, [] { return simulator_of(Scene()); }};
}

/// A sensor of such a layer.
template <const tactnet::simulation::bonded_layer& Layer>
constexpr simulated_scene on_layer(std::string_view name, std::string_view says) {
    using namespace tactnet::simulation;
    return {name, says, compliant_scene::output.rows, compliant_scene::output.columns,
            [] { return simulator_of(compliant_scene({}, {}, contact<bonded_layer>{Layer})); }};
}

} // namespace

std::span<const simulated_scene> simulated_scenes() {
    using namespace tactnet::simulation;
    static constexpr std::array list{
        named<paper_scene>("paper", "as the paper's sensor and files show it"),
        named<layered_scene>("layered", "the same with an elastic layer in place of springs, slower"),
        named<ideal_scene>("ideal", "as an array without faults would"),
        on_layer<rigid_sensor>("rigid", "a film under a thin skin on a metal plate"),
        on_layer<semi_rigid_sensor>("semi-rigid", "a film on a mat of foam rubber"),
        on_layer<flexible_sensor>("flexible", "a film on a thick soft body"),
    };
    return list;
}
