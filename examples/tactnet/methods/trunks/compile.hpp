#pragma once

// Compiles a trunk for the program. Included by the generated units only.

#include "methods/trunks/compiled.hpp"

#include <tactnet/deployment/deploy.hpp>
#include <tactnet/io/file_error.hpp>
#include <tactnet/io/pretrained.hpp>
#include <tactnet/networks.hpp>
#include <tactnet/training/initialise.hpp>
#include <tactnet/training/loop/trainable_network.hpp>
#include <tactnet/transfer/networks.hpp>

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

template <class Network>
class deployed_trunk final : public any_trunk {
public:
    explicit deployed_trunk(const Network& network) : own_(tactnet::deploy(network)) {}

    bool run(tactnet::thread_pool& threads, std::span<const float> photographs,
             std::span<float> maps) const override {
        return own_.infer(photographs, maps, threads) == tactnet::frame_status::ok;
    }

private:
    tactnet::deployed<Network> own_;
};

/// `Trunk` is one of those in networks.hpp.
template <class Trunk, std::size_t Classes>
compiled_head compile_head() {
    constexpr std::size_t features = Trunk::head_features.size(Trunk::network::output_shape);
    using head = tactnet::feature_head<features, Classes>;
    return {Trunk::head_method,
            Trunk::head_features,
            Classes,
            costs_of<head>(),
            costs_of<tactnet::feature_head<features, 1>>(),
            []() -> std::unique_ptr<tactnet::trainable> {
                return std::make_unique<tactnet::trainable_network<head>>();
            }};
}

template <class Trunk, std::size_t Classes>
class trunk_code final : public compiled_trunk {
    using Network = typename Trunk::network;

public:
    trunk_code()
        : compiled_trunk(Trunk::names(), Network::input_shape, Network::output_shape, costs_of<Network>(),
                         compile_head<Trunk, Classes>()) {}

    tactnet::stored_arrays arrays() const override { return tactnet::stored_arrays_of<Network>(); }
    std::unique_ptr<any_trunk> load(tactnet::safetensors_source& file,
                                    std::string_view prefix) const override {
        const auto network = std::make_unique<Network>();
        tactnet::load_pretrained(*network, file, names.behind, prefix);
        try {
            return std::make_unique<deployed_trunk<Network>>(*network);
        } catch (const std::invalid_argument& error) { // numbers beyond all use
            throw tactnet::file_error(file.file(), "", "weights of " + std::string(names.network.title),
                                      error.what());
        }
    }
    std::unique_ptr<any_trunk> seeded() const override {
        const auto network = std::make_unique<Network>();
        tactnet::initialise(*network, tactnet::he_normal{}, 0);
        return std::make_unique<deployed_trunk<Network>>(*network);
    }
};
