#pragma once

#include "sensing.hpp"

#include <tactnet/simulation/contact/elastic.hpp>
#include <tactnet/simulation/effects/circuit/conversion.hpp>
#include <tactnet/simulation/effects/circuit/wiring.hpp>
#include <tactnet/simulation/effects/film/response.hpp>
#include <tactnet/simulation/effects/film/time.hpp>
#include <tactnet/simulation/effects/mechanics.hpp>
#include <tactnet/simulation/effects/storage.hpp>
#include <tactnet/simulation/scene.hpp>
#if __has_include(<Eigen/Core>)
#include <tactnet/simulation/effects/circuit/resistive_network.hpp>
#endif

#include <algorithm>
#include <tuple>

namespace tactnet {
using namespace simulation; // effects are listed by their own names
}

namespace tactnet_python {

template <class Scene>
class scene_of final : public any_scene {
public:
    template <class... Given>
    explicit scene_of(double pitch, std::uint64_t unit, const Given&... given)
        : own_({pitch}, {unit}, given...) {
        surface = Scene::surface, tactels = Scene::tactels, output = Scene::output;
    }
    tactnet::contact_report touch(const float* heights, const tactnet::pressing& press,
                                  const tactnet::moment& now, float* clean, float* measured) override {
        own_.touch(tactnet::tensor_view<const float, Scene::surface>(heights), press, now, frames_);
        std::copy(frames_.clean.begin(), frames_.clean.end(), clean);
        std::copy(frames_.measured.begin(), frames_.measured.end(), measured);
        return frames_.contact;
    }
    void reset() override { own_.reset(); }

private:
    Scene own_;
    typename Scene::frames frames_;
};

template <class Scene, class... Given>
network_code code_of_scene(const Given&... given) {
    static const std::tuple<Given...> kept(given...);
    network_code code;
    code.scene = [](double pitch, std::uint64_t unit) {
        return std::apply(
            [&](const Given&... each) -> std::unique_ptr<any_scene> {
                return std::make_unique<scene_of<Scene>>(pitch, unit, each...);
            },
            kept);
    };
    return code;
}

} // namespace tactnet_python
