#pragma once

#include <tactnet/operators/layer.hpp>
#include <tactnet/runtime/random.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace random_purposes {
inline constexpr random_purpose dropout{4}; ///< the mask of one sample in one step
} // namespace random_purposes

namespace detail {

template <unsigned Percent>
[[nodiscard]] constexpr shape dropout_output(shape output) {
    static_assert(Percent < 100, "dropout: the percentage must be below 100");
    return output;
}

} // namespace detail

/// Dropout (Srivastava et al., 2014): training zeroes each element with the given probability in percent and
/// scales the others to keep the mean; inference changes nothing. The mask depends on the seed, the step, the
/// sample and the layer's place in the network alone.
template <unsigned Percent>
struct dropout {
    static constexpr std::string_view name = "dropout";
    static constexpr bool numbered = true;

    static constexpr layer_costs costs(const shape& input) { return {.output = input, .in_place = true}; }

    template <class T, shape Input>
    struct layer : layer_base<T, Input, dropout> {
        static constexpr shape output = detail::dropout_output<Percent>(Input);
        static constexpr bool by_parts = true;

        static void infer(const execution_context& context, const T*, const T*, no_memory&,
                          input_view<T, Input> in, output_view<T, Input> out) {
            if (in.data() != out.data())
                context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
                    std::copy_n(in.lane_block(b), in.lane_block_size, out.lane_block(b));
                });
        }
        static void forward(const execution_context& context, const T*, T*, no_memory&,
                            input_view<T, Input> in, output_view<T, Input> out) {
            scale_kept(context, in, out);
        }
        static void backward(const execution_context& context, const T*, no_memory&, input_view<T, Input>,
                             input_view<T, Input>, input_view<T, Input> out_gradient,
                             output_view<T, Input> in_gradient, T*) {
            if (in_gradient.data() != nullptr)
                scale_kept(context, out_gradient, in_gradient);
        }

    private:
        static constexpr std::uint64_t threshold = (std::uint64_t{1} << 32) * Percent / 100;

        static void scale_kept(const execution_context& context, input_view<T, Input> in,
                               output_view<T, Input> out) {
            const T scale = static_cast<T>(100.0 / (100 - Percent));
            context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
                for (std::size_t lane = 0; lane < kernels::lanes<T>; ++lane) {
                    const std::uint64_t layer_seed = context.seed + std::rotl(context.place, 40);
                    random_stream random(layer_seed, random_purposes::dropout, context.step,
                                         static_cast<std::uint32_t>(
                                             (context.first_lane_block + b) * kernels::lanes<T> + lane));
                    for (std::size_t e = lane; e < in.lane_block_size; e += kernels::lanes<T>)
                        out.lane_block(b)[e] = random.bits() < threshold ? T{} : in.lane_block(b)[e] * scale;
                }
            });
        }
    };
};

}} // namespace tactnet
