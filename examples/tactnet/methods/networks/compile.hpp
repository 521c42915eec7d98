#pragma once

// Compiles a network for the program. Included by the generated units only.

#include "methods/networks/compiled.hpp"

#include <tactnet/deployment.hpp>
#include <tactnet/deployment/export/deployed_header.hpp>
#include <tactnet/deployment/export/onnx_model.hpp>
#include <tactnet/io/model_file.hpp>
#include <tactnet/sensors/tekscan_6077.hpp>
#include <tactnet/training/data/labelled_samples.hpp>

#include <utility>

template <class Network, class Format>
class deployed_network final : public any_deployed {
public:
    deployed_network(tactnet::deployed<Network, Format> own, const std::vector<std::string>& classes,
                     double temperature, const tactnet::input_function& function,
                     tactnet::reflection_rule reflections)
        : own_(std::move(own)) {
        if (!classes.empty())
            own_.set_classes(classes);
        own_.set_temperature(temperature);
        own_.set_input_function(function);
        own_.set_reflections(std::move(reflections));
    }

    bool infer(tactnet::thread_pool& threads, std::span<const std::uint8_t> frames,
               std::span<float> outputs) const override {
        return own_.infer(frames, outputs, threads) == tactnet::frame_status::ok;
    }
    bool gives_probabilities() const override { return Network::ends_in_softmax; }
    std::vector<scored_class> classify(tactnet::thread_pool& threads,
                                       std::span<const std::uint8_t> frames) const override {
        std::vector<scored_class> result;
        for (const auto& found : own_.classify(frames, threads))
            found ? result.push_back({found->index, found->probability}) : refuse_logits();
        return result;
    }
    std::string header(const tactnet::header_description& says,
                       std::span<const std::uint8_t> frame) const override {
        return tactnet::deployed_header(own_, says, frame.first<Network::input_shape.size()>());
    }

private:
    tactnet::deployed<Network, Format> own_;
};

template <class Network>
constexpr std::string_view type_as_spelled() {
    return __PRETTY_FUNCTION__;
}

/// `OneClass` is the same network for a single class, of which only the costs are needed.
template <class Network, class OneClass>
compiled_network compile_network() {
    static constexpr tactnet::shape input = Network::input_shape;
    compiled_network code{
        .input = input,
        .outputs = Network::outputs,
        .costs = costs_of<Network>(),
        .costs_of_one = costs_of<OneClass>(),
        .needs_counts = Network::needs_counts,
        .type = type_as_spelled<Network>(),
        .make = []() -> std::unique_ptr<tactnet::trainable> {
            return std::make_unique<tactnet::trainable_network<Network>>();
        },
        .describe = [] { return Network::describe(); },
        .deploy = [](const any_model& model) -> std::unique_ptr<any_deployed> {
            const auto& own = static_cast<const tactnet::trainable_network<Network>&>(*model.network);
            return std::make_unique<deployed_network<Network, tactnet::single_precision>>(
                tactnet::deploy(own.network(), std::span(model.mean).template first<input.size()>(),
                                model.scale),
                model.classes, model.temperature, model.function, model.reflections);
        },
        .onnx = nullptr,
        .variation_of = nullptr};
    if constexpr (tactnet::has_onnx_form<Network>)
        code.onnx = [](const any_model& model) {
            const auto& own = static_cast<const tactnet::trainable_network<Network>&>(*model.network);
            return tactnet::onnx_model(own.network(), std::span(model.mean).template first<input.size()>(),
                                       model.scale, model.classes, model.function);
        };
    code.variation_of = [](const tactnet::shape& taken) -> tactnet::images_as_taken::variation {
        // Images of the paper's array are varied as they were taken, and reduced.
        constexpr tactnet::shape array = tactnet::tekscan_6077::extents;
        if constexpr (input != array && input.channels == 1 && input.rows <= array.rows &&
                      input.columns <= array.columns)
            if (taken == array)
                return tactnet::images_as_taken::of<array, input>({}).vary;
        return nullptr;
    };
    return code;
}
