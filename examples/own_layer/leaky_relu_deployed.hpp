#pragma once

// What the layer becomes when a network is deployed, and how its step is spelled in an exported header.

#include "leaky_relu.hpp"
#include "leaky_relu_step.hpp"

#include <tactnet/deployment/export/step_text.hpp>
#include <tactnet/deployment/lowering/lowering.hpp>

#include <cstddef>
#include <string>

template <unsigned Percent>
struct tactnet::lowering<own::leaky_relu<Percent>> {
    template <class Place>
    using at = tactnet::lowered_to<
        own::leaky_relu_step<typename Place::format, Percent, Place::layer::output, Place::input_stride>>;
};

template <unsigned Percent, tactnet::shape Map, std::size_t Stride>
struct tactnet::step_spelling<own::leaky_relu_step<tactnet::single_precision, Percent, Map, Stride>> {
    static spelled_step of(step_text& text, const shape&, const std::string& stride) {
        text.include("leaky_relu_step.hpp");
        return {"Leaky ReLU", "own::leaky_relu_step<tactnet::single_precision, " + std::to_string(Percent) +
                                  ", " + text_of(Map) + ", " + stride + ">"};
    }
};
