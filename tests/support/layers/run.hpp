#pragma once

#include <tactnet/layers/composition/layer_list.hpp>

#include <cstddef>

namespace support {

template <class Layer>
using value_of = typename Layer::value_type;

/// The forward pass of a layer on its own.
template <class Layer>
void run_forward(const tactnet::execution_context& p, const value_of<Layer>* values, value_of<Layer>* running,
                 typename Layer::memory& memory, tactnet::input_view<value_of<Layer>, Layer::input> in,
                 tactnet::output_view<value_of<Layer>, Layer::output> out) {
    if constexpr (tactnet::part_layer<Layer>) {
        if constexpr (Layer::observes)
            tactnet::for_each_part<Layer::by_parts>(
                p, in.lane_blocks(), [&](const auto& part, std::size_t first, std::size_t last) {
                    Layer::observe_forward(part, memory, in.part(first, last));
                });
        Layer::begin_forward(p, running, memory, in.samples());
    }
    tactnet::for_each_part<Layer::by_parts>(
        p, in.lane_blocks(), [&](const auto& part, std::size_t first, std::size_t last) {
            Layer::forward(part, values, running, memory, in.part(first, last), out.part(first, last));
        });
}

/// The way back of a layer on its own.
template <class Layer>
void run_backward(const tactnet::execution_context& p, const value_of<Layer>* values,
                  typename Layer::memory& memory, tactnet::input_view<value_of<Layer>, Layer::input> in,
                  tactnet::input_view<value_of<Layer>, Layer::output> out,
                  tactnet::input_view<value_of<Layer>, Layer::output> out_gradient,
                  tactnet::output_view<value_of<Layer>, Layer::input> in_gradient,
                  value_of<Layer>* gradients) {
    if constexpr (tactnet::part_layer<Layer>) {
        if constexpr (Layer::observes)
            tactnet::for_each_part<Layer::by_parts>(
                p, in.lane_blocks(), [&](const auto& part, std::size_t first, std::size_t last) {
                    Layer::observe_backward(part, memory, in.part(first, last), out.part(first, last),
                                            out_gradient.part(first, last));
                });
        Layer::begin_backward(p, values, memory, in.samples());
    }
    tactnet::for_each_part<Layer::by_parts>(
        p, in.lane_blocks(), [&](const auto& part, std::size_t first, std::size_t last) {
            Layer::backward(part, values, memory, in.part(first, last), out.part(first, last),
                            out_gradient.part(first, last), in_gradient.part(first, last), gradients);
        });
    if constexpr (tactnet::part_layer<Layer>)
        Layer::end_backward(memory, gradients);
}

} // namespace support
