#pragma once

// Compiles a trunk for the program. Included by the generated units only, each of which compiles one.

#include "methods/trunks/compiled.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/pretrained.hpp>
#include <tactnet/networks.hpp>
#include <tactnet/networks/imagenet.hpp>
#include <tactnet/training/initialise.hpp>

/// The trunks there are: a network each, up to the layer that the paper's authors took features from. A new
/// one is a struct here and its name in TACTNET_PROGRAM_TRUNKS.
namespace trunks {

constexpr photograph_network known_as(std::string_view name) {
    return *std::ranges::find(photograph_networks, name, &photograph_network::name);
}

struct squeezenet {
    static constexpr photograph_network known = known_as("squeezenet");
    using network = tactnet::squeezenet1_1_trunk<known.photograph>;
    static constexpr std::string_view features = "fire9-concat";
    static std::vector<std::string> behind() { return {"classifier."}; }
};

struct alexnet {
    static constexpr photograph_network known = known_as("alexnet");
    using network = tactnet::alexnet_fc7<known.photograph>;
    static constexpr std::string_view features = "fc7";
    static std::vector<std::string> behind() { return {"classifier.6."}; }
};

struct resnet50 {
    static constexpr photograph_network known = known_as("resnet50");
    using network = tactnet::resnet50<known.photograph>;
    static constexpr std::string_view features = "fc1000";
    static std::vector<std::string> behind() { return {}; }
};

struct vgg16 {
    static constexpr photograph_network known = known_as("vgg16");
    using network = tactnet::vgg16_fc6<known.photograph>;
    static constexpr std::string_view features = "fc6";
    static std::vector<std::string> behind() { return {"classifier.3.", "classifier.6."}; }
};

} // namespace trunks

template <class Network>
loaded_trunk deployed_trunk(const Network& network) {
    auto own = std::make_shared<const tactnet::deployed<Network>>(tactnet::deploy(network));
    return [own](tactnet::thread_pool& threads, std::span<const float> photographs, std::span<float> maps) {
        return own->infer(photographs, maps, threads) == tactnet::frame_status::ok;
    };
}

template <class Trunk>
std::shared_ptr<const compiled_trunk> compile_trunk() {
    using network = typename Trunk::network;
    return std::make_shared<const compiled_trunk>(compiled_trunk{
        .network = Trunk::known,
        .features = Trunk::features,
        .behind = Trunk::behind(),
        .photograph = network::input_shape,
        .map = network::output_shape,
        .costs = costs_of<network>(),
        .arrays = [] { return tactnet::stored_arrays_of<network>(); },
        .load =
            [](const compiled_trunk& trunk, tactnet::safetensors_source& file, std::string_view prefix) {
                const auto own = std::make_unique<network>();
                tactnet::load_pretrained(*own, file, trunk.behind, prefix);
                try {
                    return deployed_trunk(*own);
                } catch (const std::invalid_argument& error) { // numbers beyond all use
                    throw tactnet::file_error(file.file(), "",
                                              "weights of " + std::string(trunk.network.title), error.what());
                }
            },
        .seeded =
            [] {
                const auto own = std::make_unique<network>();
                tactnet::initialise(*own, tactnet::he_normal{}, 0);
                return deployed_trunk(*own);
            }});
}
