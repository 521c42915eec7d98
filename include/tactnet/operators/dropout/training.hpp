#pragma once

#include <tactnet/operators/dropout/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>
#include <tactnet/runtime/random.hpp>

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace random_purposes {
inline constexpr random_purpose dropout{4}; ///< the mask of one sample in one step
} // namespace random_purposes

template <unsigned Percent, class T, shape Input>
struct trained_layer<dropout<Percent>, T, Input> : trained_base<dropout<Percent>, T, Input> {
    static constexpr bool by_parts = true;

    static void infer(const execution_context& context, const T*, const T*, no_memory&,
                      input_view<T, Input> in, output_view<T, Input> out) {
        if (in.data() != out.data())
            context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
                std::copy_n(in.lane_block(b), in.lane_block_size, out.lane_block(b));
            });
    }
    static void forward(const execution_context& context, const T*, T*, no_memory&, input_view<T, Input> in,
                        output_view<T, Input> out) {
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
                random_stream random(
                    layer_seed, random_purposes::dropout, context.step,
                    static_cast<std::uint32_t>((context.first_lane_block + b) * kernels::lanes<T> + lane));
                for (std::size_t e = lane; e < in.lane_block_size; e += kernels::lanes<T>)
                    out.lane_block(b)[e] = random.bits() < threshold ? T{} : in.lane_block(b)[e] * scale;
            }
        });
    }
};

}} // namespace tactnet
