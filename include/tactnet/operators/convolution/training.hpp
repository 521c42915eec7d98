#pragma once

#include <tactnet/kernels/batch/methods.hpp>
#include <tactnet/kernels/batch/reductions.hpp>
#include <tactnet/operators/convolution/layer.hpp>
#include <tactnet/operators/trained_layer.hpp>

#include <algorithm>
#include <array>
#include <cstddef>

namespace tactnet { inline namespace TACTNET_ARCH {

namespace detail {

/// What a convolution and a transposed one share: inference and the backward pass of a batch. `Ahead`
/// computes the output and `Back` the gradient of the input; each is the backward pass of the other. The
/// learnable parameters are the weights of the one of them with a stride, then a bias per filter. A layer
/// adds `describe`, `prepare`, which packs `forward_weights`, and `begin_backward`, which packs
/// `backward_weights` and calls `clear_totals`.
template <class Spec, class T, shape Input, bool Transposed, kernels::batch_convolution Ahead,
          kernels::batch_convolution Back>
struct convolution_passes : trained_base<Spec, T, Input> {
    using base = trained_base<Spec, T, Input>;
    using base::output, base::weights, base::has_bias;
    static constexpr bool by_parts = true;
    static constexpr std::size_t biases = has_bias ? output.channels : 0;

    struct memory {
        aligned_vector<T> forward_weights, backward_weights;
        aligned_vector<double> totals;
        aligned_vector<T> scratch; // of every thread
        void resize(std::size_t) {}
    };

    static void infer(const execution_context& context, const T* values, const T*, memory& m,
                      input_view<T, Input> in, output_view<T, output> out) {
        detail::grow(m.scratch, context.threads.threads() * forward_method::workspace_elements);
        context.threads.on_each_share(in.lane_blocks(), [&](thread_pool::share part) {
            for (std::size_t b = part.begin(in.lane_blocks()); b < part.end(in.lane_blocks()); ++b)
                forward_method::run(m.forward_weights.data(), has_bias ? values + weights : nullptr,
                                    in.lane_block(b), out.lane_block(b),
                                    m.scratch.data() + part.index * forward_method::workspace_elements);
        });
    }
    static void backward(const execution_context& context, const T*, memory& m, input_view<T, Input> in,
                         input_view<T, output>, input_view<T, output> out_gradient,
                         output_view<T, Input> in_gradient, T*) {
        constexpr std::size_t needed =
            std::max(weight_gradient_method::workspace_elements, input_gradient_method::workspace_elements);
        detail::grow(m.scratch, context.threads.threads() * needed);
        // Threads share the weights and the biases, each adding all lane blocks in order, and the lane
        // blocks of the input gradient. Lane block by lane block, so that each is fetched from memory
        // once.
        context.threads.on_each_thread([&](thread_pool::share part) {
            T* const scratch = m.scratch.data() + part.index * needed;
            for (std::size_t b = 0; b < in.lane_blocks(); ++b) {
                const T *const x = in.lane_block(b), *const dy = out_gradient.lane_block(b);
                weight_gradient_method::add(Transposed ? dy : x, Transposed ? x : dy, m.totals.data(),
                                            scratch, part.begin(weight_gradient_method::pieces),
                                            part.end(weight_gradient_method::pieces));
                for (std::size_t f = part.begin(biases); f < part.end(biases); ++f) {
                    const T* from = dy + f * output.area() * kernels::lanes<T>;
                    m.totals[weight_gradient_method::totals + f] +=
                        kernels::sum_terms<1, T>(output.area(), [&](std::size_t i) {
                            return std::array<kernels::vector<T>, 1>{
                                kernels::load(from + i * kernels::lanes<T>)};
                        })[0];
                }
                if (in_gradient.data() != nullptr && b >= part.begin(in.lane_blocks()) &&
                    b < part.end(in.lane_blocks()))
                    input_gradient_method::run(m.backward_weights.data(), nullptr, dy,
                                               in_gradient.lane_block(b), scratch);
            }
        });
    }
    static void end_backward(memory& m, T* gradients) {
        weight_gradient_method::finish(m.totals.data(), gradients);
        for (std::size_t filter = 0; filter < biases; ++filter)
            gradients[weights + filter] = static_cast<T>(m.totals[weight_gradient_method::totals + filter]);
    }

protected:
    using forward_method = kernels::lane_convolution<Ahead, T>;
    using input_gradient_method = kernels::lane_convolution<Back, T>;
    using weight_gradient_method = kernels::weight_gradient<(Transposed ? Back : Ahead), T>;

    static void clear_totals(memory& m) { m.totals.assign(weight_gradient_method::totals + biases, 0.0); }
};

/// At least one filter: of none, the layer's sentence is the only error.
template <class Spec, class T, shape Input, class Layer = typename Spec::template layer<T, Input>,
          std::size_t Filters = std::max<std::size_t>(Layer::output.channels, 1)>
using conv2d_passes =
    convolution_passes<Spec, T, Input, false,
                       kernels::batch_convolution::forward(Layer::window, Filters, Layer::groups),
                       kernels::batch_convolution::backward(Layer::window, Filters, Layer::groups)>;

} // namespace detail

template <std::size_t Filters, extent2d Kernel, extent2d Stride, padding Padding, conv2d_options Options,
          class T, shape Input>
struct trained_layer<conv2d<Filters, Kernel, Stride, Padding, Options>, T, Input>
    : detail::conv2d_passes<conv2d<Filters, Kernel, Stride, Padding, Options>, T, Input> {
    using base = detail::conv2d_passes<conv2d<Filters, Kernel, Stride, Padding, Options>, T, Input>;
    using base::channels, base::filters;
    using typename base::memory;

    static void prepare(const execution_context&, const T* values, const T*, memory& m) {
        m.forward_weights.resize(base::forward_method::packed_elements);
        const auto weight = [&](auto filter, auto channel, auto row, auto column) {
            return values[((filter * channels + channel) * Kernel.rows + row) * Kernel.columns + column];
        };
        base::forward_method::pack(weight, m.forward_weights.data());
    }

    static void begin_backward(const execution_context&, const T* values, memory& m, std::size_t) {
        base::clear_totals(m);
        m.backward_weights.resize(base::input_gradient_method::packed_elements);
        const auto weight = [&](auto channel, auto filter, auto row, auto column) {
            const std::size_t group = channel / channels;
            return values[(((group * filters + filter) * channels + channel % channels) * Kernel.rows +
                           (Kernel.rows - 1 - row)) *
                              Kernel.columns +
                          (Kernel.columns - 1 - column)];
        };
        base::input_gradient_method::pack(weight, m.backward_weights.data());
    }
};

}} // namespace tactnet
