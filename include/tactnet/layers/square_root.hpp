#pragma once

#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/layers/layer.hpp>

#include <ratio>
#include <string_view>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// y = √(x + offset) − √offset, and 0 for x below 0: in front of a network of counts, which are the noisier
/// the larger they are; of their root the noise is nearly the same everywhere (Anscombe, "The transformation
/// of Poisson, binomial and negative-binomial data", 1948, whose offset is ⅜ of a count). What is not touched
/// stays 0. `Offset` is a fraction (std::ratio) above zero in units of the input; as it is, ⅜ of a count of
/// 8 bits that was divided by 255. In place.
template <class Offset = std::ratio<3, 8 * 255>>
struct square_root {
    static constexpr std::string_view name = "square_root";
    static constexpr bool numbered = true;
    static constexpr bool takes_counts = true; ///< inputs below 0 would be lost, as minus a mean image
    static_assert(std::ratio_greater_v<Offset, std::ratio<0>>, "square_root: the offset must be above zero");
    static constexpr double offset = static_cast<double>(Offset::num) / static_cast<double>(Offset::den);

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, square_root> {
        static constexpr bool by_parts = true;

        static void infer(const execution_context& p, const T*, const T*, no_memory&, input_view<T, Input> in,
                          output_view<T, Input> out) {
            p.threads.for_each(in.lane_blocks(), [&](std::size_t g) {
                kernels::shifted_root_forward(static_cast<T>(offset), in.lane_block(g), out.lane_block(g),
                                              in.lane_block_size);
            });
        }
        static void forward(const execution_context& p, const T* none, T*, no_memory& m,
                            input_view<T, Input> in, output_view<T, Input> out) {
            infer(p, none, none, m, in, out);
        }
        static void backward(const execution_context& p, const T*, no_memory&, input_view<T, Input>,
                             input_view<T, Input> out, input_view<T, Input> out_gradient,
                             output_view<T, Input> in_gradient, T*) {
            if (in_gradient.data() == nullptr)
                return;
            p.threads.for_each(out.lane_blocks(), [&](std::size_t g) {
                kernels::shifted_root_backward(static_cast<T>(offset), out.lane_block(g),
                                               out_gradient.lane_block(g), in_gradient.lane_block(g),
                                               out.lane_block_size);
            });
        }
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet
