#include "commands/scenes.hpp"

#include <tactnet/simulation/paper/scene.hpp>
#include <tactnet/simulation/paper/simulate.hpp>

#include <algorithm>
#include <array>

namespace {

template <class Scene>
class scene_simulator final : public simulator {
public:
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

} // namespace

std::span<const simulated_scene> simulated_scenes() {
    using namespace tactnet::simulation;
    static constexpr std::array list{
        named<paper_scene>("paper", "as the paper's sensor and files show it"),
        named<layered_scene>("layered", "the same with an elastic layer in place of springs, slower"),
        named<ideal_scene>("ideal", "as an array without faults would"),
    };
    return list;
}
