#pragma once

// What the layer does in a deployed network. A target that runs an exported network needs this file alone.

#include <tactnet/deployment/steps/description.hpp>
#include <tactnet/deployment/steps/step.hpp>

#include <cstddef>
#include <type_traits>

namespace own {

/// In place of `Map`, whose pixels lie `Stride` elements apart. Lanes behind the last channel stay zero.
template <class Format, unsigned Percent, tactnet::shape Map, std::size_t Stride>
struct leaky_relu_step;

template <unsigned Percent, tactnet::shape Map, std::size_t Stride>
struct leaky_relu_step<tactnet::single_precision, Percent, Map, Stride>
    : tactnet::step_without_parameters<tactnet::single_precision, Map, Stride> {
    static void run(const float*, const float* in, float* out, float*) noexcept {
        constexpr float slope = static_cast<float>(Percent) / 100;
        for (std::size_t e = 0; e < Map.area() * Stride; ++e)
            out[e] = in[e] > 0 ? in[e] : slope * in[e];
    }
};

} // namespace own

template <class Format, unsigned Percent, tactnet::shape Map, std::size_t Stride>
struct tactnet::step_description<own::leaky_relu_step<Format, Percent, Map, Stride>> {
    static constexpr const char* header = "leaky_relu_step.hpp";
    static constexpr void visit(auto&& to) {
        to("own::leaky_relu_step", "Leaky ReLU", std::type_identity<Format>{}, Percent, Map,
           tactnet::input_stride{});
    }
};
