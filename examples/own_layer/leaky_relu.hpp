#pragma once

// A layer of one's own, as good as one of the library's: leaky ReLU (Maas, Hannun, Ng, 2013), x where x > 0
// and a small share of x elsewhere, so that no filter stops learning. This file is all that it takes to train
// it, to save it and to run it in batches.

#include <tactnet/layers/layer.hpp>

#include <cstddef>
#include <string_view>

namespace own {

/// max(x, 0) + slope · min(x, 0), with the slope in per cent.
template <unsigned Percent = 1>
struct leaky_relu {
    static_assert(Percent > 0 && Percent < 100,
                  "leaky_relu: the slope must be above 0 and below 100 per cent");

    /// What arrays of the layer are called in weight files; this one has none.
    static constexpr std::string_view name = "leaky_relu";
    static constexpr bool numbered = true;

    /// What it gives and costs for an input of any size. The way back needs the output alone, which has the
    /// input's sign.
    static constexpr tactnet::layer_costs costs(const tactnet::shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    /// Bound to a number type and an input shape.
    template <class T, tactnet::shape Input>
    struct layer : tactnet::layer_base<T, Input, leaky_relu> {
        static constexpr bool by_parts = true;
        static constexpr T slope = static_cast<T>(Percent) / 100;

        static void infer(const tactnet::execution_context& p, const T*, const T*, tactnet::no_memory&,
                          tactnet::input_view<T, Input> in, tactnet::output_view<T, Input> out) {
            p.threads.for_each(in.lane_blocks(), [&](std::size_t g) {
                for (std::size_t e = 0; e < in.lane_block_size; ++e)
                    out.lane_block(g)[e] =
                        in.lane_block(g)[e] > 0 ? in.lane_block(g)[e] : slope * in.lane_block(g)[e];
            });
        }
        static void forward(const tactnet::execution_context& p, const T* none, T*,
                            tactnet::no_memory& memory, tactnet::input_view<T, Input> in,
                            tactnet::output_view<T, Input> out) {
            infer(p, none, none, memory, in, out);
        }
        static void backward(const tactnet::execution_context& p, const T*, tactnet::no_memory&,
                             tactnet::input_view<T, Input>, tactnet::input_view<T, Input> out,
                             tactnet::input_view<T, Input> out_gradient,
                             tactnet::output_view<T, Input> in_gradient, T*) {
            if (in_gradient.data() == nullptr) // no layer in front learns
                return;
            p.threads.for_each(out.lane_blocks(), [&](std::size_t g) {
                for (std::size_t e = 0; e < out.lane_block_size; ++e)
                    in_gradient.lane_block(g)[e] = out.lane_block(g)[e] > 0
                                                       ? out_gradient.lane_block(g)[e]
                                                       : slope * out_gradient.lane_block(g)[e];
            });
        }
    };
};

} // namespace own
