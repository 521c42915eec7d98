#pragma once

#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/layers/layer.hpp>

#include <array>

namespace tactnet {
inline namespace TACTNET_ARCH {

/// Softmax over the channels of every pixel, for lists that end in probabilities. The networks of the paper
/// end in logits; training joins softmax and cross-entropy (training/loss.hpp), which is exact where
/// probabilities are not, so a network knows its logits whether its list ends in softmax or not.
struct softmax {
    static constexpr std::string_view name = "softmax";
    static constexpr bool numbered = false;

    static constexpr layer_costs costs(const shape& input) {
        return {.output = input, .in_place = true, .keeps_output = true};
    }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, softmax> {
        static constexpr bool by_parts = true;

        static void infer(const execution_context& p, const T*, const T*, no_memory&, input_view<T, Input> in,
                          output_view<T, Input> out) {
            p.threads.for_each(in.lane_blocks(), [&](std::size_t g) {
                for_each_pixel([&](std::size_t first) {
                    std::array<T, Input.channels> x;
                    for (std::size_t c = 0; c < Input.channels; ++c)
                        x[c] = in.lane_block(g)[first + c * plane];
                    kernels::softmax_of<T>(x, x);
                    for (std::size_t c = 0; c < Input.channels; ++c)
                        out.lane_block(g)[first + c * plane] = x[c];
                });
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
                for_each_pixel([&](std::size_t first) {
                    const T *y = out.lane_block(g) + first, *dy = out_gradient.lane_block(g) + first;
                    double product = 0;
                    for (std::size_t c = 0; c < Input.channels; ++c)
                        product += static_cast<double>(y[c * plane]) * static_cast<double>(dy[c * plane]);
                    for (std::size_t c = 0; c < Input.channels; ++c)
                        in_gradient.lane_block(g)[first + c * plane] =
                            static_cast<T>(static_cast<double>(y[c * plane]) *
                                           (static_cast<double>(dy[c * plane]) - product));
                });
            });
        }

    private:
        static constexpr std::size_t plane = Input.area() * kernels::lanes<T>;

        /// Lanes without a sample too: what is left in them would reach the layers around.
        template <class Body>
        static void for_each_pixel(Body&& body) {
            for (std::size_t i = 0; i < plane; ++i)
                body(i);
        }
    };
};

} // namespace TACTNET_ARCH
} // namespace tactnet
