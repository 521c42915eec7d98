#include "commands/scenes.hpp"

#include <tactnet/simulation/contact/bonded_layer.hpp>
#include <tactnet/simulation/paper/objects.hpp>
#include <tactnet/simulation/paper/scene.hpp>

#include <algorithm>
#include <array>
#include <utility>

namespace {

template <class Scene>
class scene_simulator final : public simulator {
public:
    explicit scene_simulator(Scene scene = {}) : scene_(std::move(scene)) {}

    simulated_image image(std::size_t label, std::uint64_t seed, std::uint32_t number) override {
        tactnet::simulation::simulate_paper_touch(scene_, label, seed, number, frames_);
        simulated_image result{std::vector<std::uint8_t>(Scene::output.size()), frames_.contact.converged};
        std::ranges::transform(frames_.measured, result.counts.begin(),
                               [](float count) { return static_cast<std::uint8_t>(count); });
        return result;
    }

private:
    Scene scene_;
    typename Scene::frames frames_;
};

template <class Scene>
constexpr simulated_scene named(std::string_view name, std::string_view says) {
    return {name, says, Scene::output.rows, Scene::output.columns,
            []() -> std::unique_ptr<simulator> { return std::make_unique<scene_simulator<Scene>>(); }};
}

/// A sensor of such a layer.
template <const tactnet::simulation::bonded_layer& Layer>
constexpr simulated_scene on_layer(std::string_view name, std::string_view says) {
    using tactnet::simulation::compliant_scene, tactnet::simulation::contact,
        tactnet::simulation::bonded_layer;
    return {name, says, compliant_scene::output.rows, compliant_scene::output.columns,
            []() -> std::unique_ptr<simulator> {
                return std::make_unique<scene_simulator<compliant_scene>>(
                    compliant_scene({}, {}, contact<bonded_layer>{Layer}));
            }};
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
