#pragma once

#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/kernels/elementwise.hpp>
#include <tactnet/kernels/rows/operations.hpp>
#include <tactnet/operators/activations/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>
#include <tactnet/runtime/random.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

template <class Function, class T, shape Input>
struct trained_layer<activation<Function>, T, Input> : lane_block_layer<activation<Function>, T, Input> {
    static constexpr std::size_t elements = Input.size() * kernels::lanes<T>;

    static void forward_block(const T* in, T* out) {
        if constexpr (detail::is_relu<Function>())
            kernels::relu_forward(in, out, elements);
        else
            detail::transform<Function>([](auto x) { return Function::value(x); }, elements, out, in);
    }
    static void backward_block(const T* in, const T* out, const T* out_gradient, T* in_gradient) {
        if constexpr (detail::is_relu<Function>())
            kernels::relu_backward(out, out_gradient, in_gradient, elements);
        else if constexpr (detail::needs_input<Function>)
            detail::transform<Function>([](auto x, auto g) { return Function::backward_from_input(x, g); },
                                        elements, in_gradient, in, out_gradient);
        else
            detail::transform<Function>([](auto y, auto g) { return Function::backward(y, g); }, elements,
                                        in_gradient, out, out_gradient);
    }
};

template <class T, shape Input>
struct trained_layer<parametric_relu, T, Input> : trained_base<parametric_relu, T, Input> {
    using base = trained_base<parametric_relu, T, Input>;
    using base::channels;
    static constexpr bool by_parts = true;

    struct memory {
        std::vector<double> sums;    // of every lane block and channel
        std::size_t lane_blocks = 0; // of the batch
        void resize(std::size_t samples) { sums.resize(lane_blocks_of<T>(samples) * channels); }
    };

    static void infer(const execution_context& context, const T* values, const T*, memory&,
                      input_view<T, Input> in, output_view<T, Input> out) {
        const vector zero(T{});
        each_channel(context, in.lane_blocks(), [&](std::size_t b, std::size_t c) {
            kernels::transform_vectors(
                [slope = vector(values[c]), zero](const vector& x) {
                    return kernels::choose<T>(x > zero, x, slope * x);
                },
                plane, out.lane_block(b) + c * plane, in.lane_block(b) + c * plane);
        });
    }

    static void begin_backward(const execution_context&, const T*, memory& m, std::size_t samples) {
        m.lane_blocks = lane_blocks_of<T>(samples);
    }
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, Input>, input_view<T, Input> out_gradient,
                         output_view<T, Input> in_gradient, T*) {
        const vector zero(T{});
        each_channel(context, in.lane_blocks(), [&](std::size_t b, std::size_t c) {
            const T *x = in.lane_block(b) + c * plane, *dy = out_gradient.lane_block(b) + c * plane;
            // Before the gradient of the input, which may be written over that of the output.
            m.sums[(context.first_lane_block + b) * channels + c] =
                kernels::sum_terms<1, T>(Input.area(), [&](std::size_t i) {
                    const vector value = kernels::load(x + i * kernels::lanes<T>),
                                 gradient = kernels::load(dy + i * kernels::lanes<T>);
                    return std::array<vector, 1>{kernels::choose<T>(value > zero, zero, value * gradient)};
                })[0];
            if (in_gradient.data() != nullptr)
                kernels::transform_vectors(
                    [slope = vector(values[c]), zero](const vector& value, const vector& gradient) {
                        return kernels::choose<T>(value > zero, gradient, slope * gradient);
                    },
                    plane, in_gradient.lane_block(b) + c * plane, x, dy);
        });
    }
    static void end_backward(memory& m, T* gradients) {
        for (std::size_t c = 0; c < channels; ++c) {
            double sum = 0;
            for (std::size_t b = 0; b < m.lane_blocks; ++b)
                sum += m.sums[b * channels + c];
            gradients[c] = static_cast<T>(sum);
        }
    }

private:
    using vector = kernels::vector<T>;
    static constexpr std::size_t plane = Input.area() * kernels::lanes<T>;

    /// Calls body(lane block, channel).
    template <class Body>
    static void each_channel(const execution_context& context, std::size_t lane_blocks, const Body& body) {
        context.threads.for_each(lane_blocks, [&](std::size_t b) {
            for (std::size_t c = 0; c < channels; ++c)
                body(b, c);
        });
    }
};

template <class Offset, class T, shape Input>
struct trained_layer<square_root<Offset>, T, Input> : lane_block_layer<square_root<Offset>, T, Input> {
    static constexpr T offset = static_cast<T>(square_root<Offset>::offset);
    static constexpr std::size_t elements = Input.size() * kernels::lanes<T>;

    static void forward_block(const T* in, T* out) {
        kernels::transform_vectors(kernels::shifted_root(offset), elements, out, in);
    }
    static void backward_block(const T*, const T* out, const T* out_gradient, T* in_gradient) {
        kernels::shifted_root_backward(offset, out, out_gradient, in_gradient, elements);
    }
};

template <class T, shape Input>
struct trained_layer<softmax, T, Input> : lane_block_layer<softmax, T, Input> {
    // Also computes lanes without a sample, which the neighbouring layers read.
    static constexpr std::size_t plane = Input.area() * kernels::lanes<T>;

    static void forward_block(const T* in, T* out) {
        for (std::size_t i = 0; i < plane; ++i) {
            std::array<T, Input.channels> x;
            for (std::size_t c = 0; c < Input.channels; ++c)
                x[c] = in[i + c * plane];
            kernels::softmax_of<T>(x, x);
            for (std::size_t c = 0; c < Input.channels; ++c)
                out[i + c * plane] = x[c];
        }
    }
    static void backward_block(const T*, const T* out, const T* out_gradient, T* in_gradient) {
        for (std::size_t i = 0; i < plane; ++i) {
            const T *y = out + i, *dy = out_gradient + i;
            double product = 0;
            for (std::size_t c = 0; c < Input.channels; ++c)
                product += static_cast<double>(y[c * plane]) * static_cast<double>(dy[c * plane]);
            for (std::size_t c = 0; c < Input.channels; ++c)
                in_gradient[i + c * plane] = static_cast<T>(static_cast<double>(y[c * plane]) *
                                                            (static_cast<double>(dy[c * plane]) - product));
        }
    }
};

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
