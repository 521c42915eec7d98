#pragma once

// Compiles a network for the program. Included by the generated units only.

#include "methods/networks/compiled.hpp"
#include "methods/networks/deployed_network.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/io/parameters.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/training/data/labelled_samples.hpp>
#include <tactnet/training/loop/trainable_network.hpp>

#include <memory>

/// `OneClass` is the same network for a single class, of which nothing but the costs is asked.
template <class Network, class OneClass>
class network_code final : public compiled_network {
    static constexpr tactnet::shape input = Network::input_shape;
    using trainable = tactnet::trainable_network<Network>;
    /// Images of the paper's array are varied as they were taken, and reduced.
    static constexpr tactnet::shape array = tactnet::tekscan_6077::extents;
    static constexpr bool smaller =
        input != array && input.channels == 1 && input.rows <= array.rows && input.columns <= array.columns;

public:
    network_code()
        : compiled_network(input.rows, input.columns, Network::outputs, costs_of<Network>(),
                           costs_of<OneClass>(), Network::takes_counts) {}

    std::unique_ptr<tactnet::trainable> make() const override { return std::make_unique<trainable>(); }
    std::string_view type() const override { return __PRETTY_FUNCTION__; }
    std::vector<tactnet::parameter> describe() const override { return Network::describe(); }
    std::unique_ptr<any_deployed> deploy(const any_model& model) const override {
        return std::make_unique<deployed_network<Network, tactnet::single_precision>>(tactnet::deploy(
            network_of(model), std::span(model.mean).template first<input.size()>(), model.scale));
    }
    tactnet::images_as_taken::variation variation_of(const tactnet::shape& taken) const override {
        if constexpr (smaller)
            return taken == array ? tactnet::images_as_taken::of<array, input>({}).vary : nullptr;
        else
            return nullptr;
    }

private:
    static const Network& network_of(const any_model& model) {
        return static_cast<const trainable&>(*model.network).network();
    }
};
