#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/operators/layer.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/batch.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>

// How layers compute batches: inference and the forward and backward pass of training, in an operator's
// training.hpp. The parameters of a network lie in one flat array.

namespace tactnet { inline namespace TACTNET_ARCH {

/// A batch to read, in lanes as wide as the instruction set's registers.
template <class T, shape Shape>
struct input_view : batch_view<const T, Shape, kernels::lanes<T>> {
    using base = batch_view<const T, Shape, kernels::lanes<T>>;
    using base::base;
    constexpr input_view(const base& view) : base(view) {}
};
/// A batch to write.
template <class T, shape Shape>
struct output_view : batch_view<T, Shape, kernels::lanes<T>> {
    using base = batch_view<T, Shape, kernels::lanes<T>>;
    using base::base;
    constexpr output_view(const base& view) : base(view) {}
};

/// The number of lane blocks that hold a number of samples.
template <class T>
[[nodiscard]] constexpr std::size_t lane_blocks_of(std::size_t samples) {
    return kernels::padded_size<T>(samples) / kernels::lanes<T>;
}

/// The settings of a call, which a network passes to its layers with each batch.
struct execution_context {
    thread_pool& threads;
    double epsilon = 1e-5;            ///< added to the variance by norms
    double momentum = 0.1;            ///< share of a batch in the running statistics of batch norms
    std::uint64_t seed = 0;           ///< for dropout
    std::uint32_t step = 0;           ///< batches so far, for dropout
    std::uint64_t place = 0;          ///< of the layer among all layers of the network, for dropout
    std::size_t first_lane_block = 0; ///< of the part of the batch that the layer sees

    /// The context of layer `index` of a list, so that no two dropouts of a network draw the same numbers.
    [[nodiscard]] execution_context of_inner(std::size_t index) const {
        return nested(index < skip ? index : index + 1);
    }
    /// The context of the skip of a residual block, whose other branch is a list.
    [[nodiscard]] execution_context of_skip() const { return nested(skip); }

private:
    static constexpr std::size_t skip = 63;

    /// Each level adds six bits to the place, up to the fourth. Deeper places and larger indices are hashed
    /// (SplitMix64): two of them share their numbers with a probability of 2⁻⁶³.
    [[nodiscard]] execution_context nested(std::size_t index) const {
        execution_context inner = *this;
        inner.place = place * 64 + index + 1;
        if (index > skip || inner.place >= std::uint64_t{1} << 24U) {
            std::uint64_t mixed = place + 0x9E3779B97F4A7C15 * (index + 1);
            mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9;
            mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EB;
            inner.place = (mixed ^ (mixed >> 31U)) | std::uint64_t{1} << 63U;
        }
        return inner;
    }
};

/// A layer that computes batches: constants and static functions, without state. What the backward pass of a
/// batch needs lies in its `memory`.
template <class Layer, class T = typename Layer::value_type>
concept batch_layer =
    std::floating_point<T> &&
    requires(const execution_context& context, const T* parameters, T* statistics,
             typename Layer::memory& memory, batch_view<const T, Layer::input, kernels::lanes<T>> in,
             batch_view<T, Layer::output, kernels::lanes<T>> out,
             batch_view<const T, Layer::output, kernels::lanes<T>> out_gradient,
             batch_view<T, Layer::input, kernels::lanes<T>> in_gradient, T* parameter_gradients) {
        // Whether it can write over its input. `backward` then must not need the input.
        { Layer::in_place } -> std::convertible_to<bool>;
        // Whether `backward` needs the output as the layer left it.
        { Layer::keeps_output } -> std::convertible_to<bool>;
        // Whether it processes a batch part by part (see part_layer).
        { Layer::by_parts } -> std::convertible_to<bool>;
        // Whether it must see all parts of the batch before it computes the first.
        { Layer::observes } -> std::convertible_to<bool>;
        memory.resize(std::size_t{});
        // Called once after parameters changed.
        Layer::prepare(context, parameters, statistics, memory);
        // Inference, with running statistics.
        Layer::infer(context, parameters, statistics, memory, in, out);
        // Training, with the statistics of the batch.
        Layer::forward(context, parameters, statistics, memory, in, out);
        // Sets the gradient of the input unless its view is null, and those of the parameters unless the
        // layer works by parts.
        Layer::backward(context, parameters, memory, in, out_gradient, out_gradient, in_gradient,
                        parameter_gradients);
    };

/// A layer that must see the whole batch before it computes any of it.
template <class Layer, class T = typename Layer::value_type>
concept observing_layer = requires(const execution_context& context, typename Layer::memory& memory,
                                   batch_view<const T, Layer::input, kernels::lanes<T>> in,
                                   batch_view<const T, Layer::output, kernels::lanes<T>> out,
                                   batch_view<const T, Layer::output, kernels::lanes<T>> out_gradient) {
    Layer::observe_forward(context, memory, in);
    Layer::observe_backward(context, memory, in, out, out_gradient);
};

/// A layer that processes a batch part by part, so that the next layer finds each part in the caches. Parts
/// are whole lane blocks, at most as many as there are threads, and come in order. Views are of the part,
/// `execution_context::first_lane_block` is where it begins, and the memory is that of the whole batch. The
/// calls for one batch are, in this order,
///   observe_forward(part) …  begin_forward  forward(part) …
///   observe_backward(part) … begin_backward backward(part) … end_backward
/// and `end_backward` sets the gradients of the parameters.
template <class Layer, class T = typename Layer::value_type>
concept part_layer = batch_layer<Layer> && Layer::by_parts &&
                     (!Layer::observes || observing_layer<Layer>)&&requires(
                         const execution_context& context, const T* parameters, T* statistics,
                         typename Layer::memory& memory, std::size_t samples, T* parameter_gradients) {
                         Layer::begin_forward(context, statistics, memory, samples);
                         Layer::begin_backward(context, parameters, memory, samples);
                         Layer::end_backward(memory, parameter_gradients);
                     };

/// A layer that a list can hold.
template <class Layer>
concept listed_layer = part_layer<Layer> || (batch_layer<Layer> && !Layer::by_parts && !Layer::observes);

/// The layer that computes the batches of a specification. Specialised for each, by trained_base or
/// lane_block_layer and what differs from it.
template <class Spec, class T, shape Input>
struct trained_layer;

/// The memory of a layer that needs none.
struct no_memory {
    void resize(std::size_t) {}
};

/// The defaults of a layer that computes batches.
template <class Spec, class T, shape Input>
struct trained_base : Spec::template layer<T, Input> {
    using memory = no_memory;
    static constexpr bool by_parts = false, observes = false;

    static void prepare(const execution_context&, const T*, const T*, auto&) {}
    /// Computes what inference does.
    static void forward(const execution_context& context, const T* values, T* running, auto& memory,
                        input_view<T, Input> in, auto out) {
        trained_layer<Spec, T, Input>::infer(context, values, running, memory, in, out);
    }
    static void begin_forward(const execution_context&, T*, auto&, std::size_t) {}
    static void begin_backward(const execution_context&, const T*, auto&, std::size_t) {}
    static void end_backward(auto&, T*) {}
};

/// A layer without parameters that computes each lane block by itself. `trained_layer<Spec, T, Input>`
/// has only
///
///     static void forward_block(const T* in, T* out);
///     static void backward_block(const T* in, const T* out, const T* out_gradient, T* in_gradient);
template <class Spec, class T, shape Input>
struct lane_block_layer : trained_base<Spec, T, Input> {
    using trained_base<Spec, T, Input>::output;
    static constexpr bool by_parts = true;

    static void infer(const execution_context& context, const T*, const T*, no_memory&,
                      input_view<T, Input> in, output_view<T, output> out) {
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            trained_layer<Spec, T, Input>::forward_block(in.lane_block(b), out.lane_block(b));
        });
    }
    static void backward(const execution_context& context, const T*, no_memory&, input_view<T, Input> in,
                         input_view<T, output> out, input_view<T, output> out_gradient,
                         output_view<T, Input> in_gradient, T*) {
        if (in_gradient.data() == nullptr)
            return;
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            trained_layer<Spec, T, Input>::backward_block(
                in.lane_block(b), out.lane_block(b), out_gradient.lane_block(b), in_gradient.lane_block(b));
        });
    }
};

namespace detail {

/// `Layer::forward` in training, else `Layer::infer`.
template <bool Training, class Layer, class T, class Statistic>
void run(const execution_context& context, const T* values, Statistic* running,
         typename Layer::memory& memory, input_view<T, Layer::input> in, output_view<T, Layer::output> out) {
    if constexpr (Training)
        Layer::forward(context, values, running, memory, in, out);
    else
        Layer::infer(context, values, running, memory, in, out);
}

/// Copies one frame of a lane block [feature][frame][lane] to or from contiguous vectors [feature][lane].
template <shape Sequence, class T>
void read_frame(const T* sequence, std::size_t frame, T* to) {
    for (std::size_t f = 0; f < Sequence.channels; ++f)
        kernels::store(to + f * kernels::lanes<T>,
                       kernels::load(sequence + (f * Sequence.rows + frame) * kernels::lanes<T>));
}
template <shape Sequence, class T>
void write_frame(const T* from, std::size_t frame, T* sequence) {
    for (std::size_t f = 0; f < Sequence.channels; ++f)
        kernels::store(sequence + (f * Sequence.rows + frame) * kernels::lanes<T>,
                       kernels::load(from + f * kernels::lanes<T>));
}

} // namespace detail

}} // namespace tactnet
