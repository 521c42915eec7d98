#pragma once

#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/operators/rms_norm/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>
#include <tactnet/tensor/aligned.hpp>

#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

/// Computes in double and rounds once, `lanes<double>` samples at a time.
template <class T, shape Input>
struct trained_layer<rms_norm, T, Input> : trained_base<rms_norm, T, Input> {
    static constexpr bool by_parts = true;

    struct memory {
        aligned_vector<double> totals; // gradients of the weights, [lane block][channel][lane of double]
        void resize(std::size_t) {}
    };

    static void infer(const execution_context& context, const T* values, const T*, memory&,
                      input_view<T, Input> in, output_view<T, Input> out) {
        for_each_pixel(context, in.lane_blocks(), [&](std::size_t b, std::size_t first) {
            const T* const x = in.lane_block(b) + first;
            T* const y = out.lane_block(b) + first;
            const vector inverse = inverse_root(context.epsilon, x);
            for (std::size_t c = 0; c < Input.channels; ++c)
                kernels::store_double(y + c * plane,
                                      kernels::load_double(x + c * plane) * (inverse * weight(values, c)));
        });
    }
    static void begin_backward(const execution_context&, const T*, memory& m, std::size_t samples) {
        m.totals.assign(lane_blocks_of<T>(samples) * totals_of_block, 0.0);
    }
    static void backward(const execution_context& context, const T* values, memory& m,
                         input_view<T, Input> in, input_view<T, Input>, input_view<T, Input> out_gradient,
                         output_view<T, Input> in_gradient, T*) {
        for_each_pixel(context, in.lane_blocks(), [&](std::size_t b, std::size_t first) {
            const T *const x = in.lane_block(b) + first, *const dy = out_gradient.lane_block(b) + first;
            double* const totals = m.totals.data() + (context.first_lane_block + b) * totals_of_block;
            const vector inverse = inverse_root(context.epsilon, x);
            vector slope(0.0); // of the whole pixel
            for (std::size_t c = 0; c < Input.channels; ++c) {
                const vector of_weight =
                    kernels::load_double(dy + c * plane) * (kernels::load_double(x + c * plane) * inverse);
                double* const total = totals + c * kernels::lanes<double>;
                kernels::store(total, kernels::load<double>(total) + of_weight);
                slope = slope + weight(values, c) * of_weight;
            }
            if (in_gradient.data() == nullptr)
                return;
            slope = slope * inverse * vector(1.0 / Input.channels);
            T* const dx = in_gradient.lane_block(b) + first;
            for (std::size_t c = 0; c < Input.channels; ++c)
                kernels::store_double(dx + c * plane,
                                      (weight(values, c) * kernels::load_double(dy + c * plane) -
                                       kernels::load_double(x + c * plane) * slope) *
                                          inverse);
        });
    }
    static void end_backward(memory& m, T* gradients) {
        for (std::size_t c = 0; c < Input.channels; ++c) {
            double sum = 0;
            for (std::size_t at = c * kernels::lanes<double>; at < m.totals.size(); at += totals_of_block)
                for (std::size_t lane = 0; lane < kernels::lanes<double>; ++lane)
                    sum += m.totals[at + lane];
            gradients[c] = static_cast<T>(sum);
        }
    }

private:
    using vector = kernels::vector<double>;
    static constexpr std::size_t plane = Input.area() * kernels::lanes<T>,
                                 totals_of_block = Input.channels * kernels::lanes<double>;

    /// body(lane block, element): the first channel of each pixel, for some of the samples.
    template <class Body>
    static void for_each_pixel(const execution_context& context, std::size_t lane_blocks, const Body& body) {
        context.threads.for_each(lane_blocks, [&](std::size_t b) {
            for (std::size_t first = 0; first < plane; first += kernels::lanes<double>)
                body(b, first);
        });
    }
    static vector weight(const T* values, std::size_t c) { return vector(static_cast<double>(values[c])); }
    static vector inverse_root(double epsilon, const T* x) {
        vector squares(0.0);
        for (std::size_t c = 0; c < Input.channels; ++c) {
            const vector value = kernels::load_double(x + c * plane);
            squares = squares + value * value;
        }
        return vector(1.0) /
               kernels::square_root<double>(squares * vector(1.0 / Input.channels) + vector(epsilon));
    }
};

}} // namespace tactnet
