#pragma once

#include <tactnet/kernels/batch/normalisation.hpp>
#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/operators/channel_scale/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <array>
#include <cstddef>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

template <class T, shape Input>
struct trained_layer<channel_scale, T, Input> : trained_base<channel_scale, T, Input> {
    static constexpr bool by_parts = true;

    struct memory {
        std::vector<double> sums; // of every lane block and channel
        void resize(std::size_t) {}
    };

    static void infer(const execution_context& context, const T* values, const T*, memory&,
                      input_view<T, Input> in, output_view<T, Input> out) {
        scale(context, values, in, out);
    }
    static void begin_backward(const execution_context&, const T*, memory& m, std::size_t samples) {
        m.sums.resize(lane_blocks_of<T>(samples) * Input.channels);
    }
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, Input>, input_view<T, Input> out_gradient,
                         output_view<T, Input> in_gradient, T*) {
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            for (std::size_t c = 0; c < Input.channels; ++c) {
                const T *x = in.lane_block(b) + c * plane, *dy = out_gradient.lane_block(b) + c * plane;
                m.sums[(context.first_lane_block + b) * Input.channels + c] =
                    kernels::sum_terms<1, T>(Input.area(), [&](std::size_t i) {
                        return std::array<kernels::vector<T>, 1>{kernels::load(x + i * kernels::lanes<T>) *
                                                                 kernels::load(dy + i * kernels::lanes<T>)};
                    })[0];
            }
        });
        if (in_gradient.data() != nullptr)
            scale(context, values, out_gradient, in_gradient);
    }
    static void end_backward(memory& m, T* gradients) {
        for (std::size_t c = 0; c < Input.channels; ++c) {
            double sum = 0;
            for (std::size_t at = c; at < m.sums.size(); at += Input.channels)
                sum += m.sums[at];
            gradients[c] = static_cast<T>(sum);
        }
    }

private:
    static constexpr std::size_t plane = Input.area() * kernels::lanes<T>;

    static void scale(const execution_context& context, const T* values, input_view<T, Input> in,
                      output_view<T, Input> out) {
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            for (std::size_t c = 0; c < Input.channels; ++c)
                kernels::normalise(kernels::normalising<T>{0, values[c], 0}, in.lane_block(b) + c * plane,
                                   out.lane_block(b) + c * plane, plane);
        });
    }
};

}} // namespace tactnet
