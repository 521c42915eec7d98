#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/operators/costs.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/batch.hpp>
#include <tactnet/tensor/named_array.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

// A list of layers holds specifications without sizes (`conv2d<8, 5>`). Bound to a number type and an input
// shape, a specification becomes a layer: constants and static functions, without state. The parameters of a
// network lie in one flat array, and what the backward pass of a batch needs lies in the layer's `memory`.

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

/// What an array of a network is for.
enum class parameter_role { weight, bias, scale, shift, slope, running_mean, running_variance };

/// Whether gradient descent changes the array; running statistics are not learnable.
[[nodiscard]] constexpr bool learnable(parameter_role r) {
    return r != parameter_role::running_mean && r != parameter_role::running_variance;
}

/// The elements of an array before training; weights are then drawn at random.
[[nodiscard]] constexpr double initial_value(parameter_role r) {
    return r == parameter_role::scale || r == parameter_role::running_variance ? 1
           : r == parameter_role::slope                                        ? 0.25
                                                                               : 0;
}

/// One array of a network. Its offset, in elements, is into the learnable parameters of the network or into
/// its statistics.
struct parameter : named_array {
    parameter_role role; ///< decides how initialisation and weight decay treat it
    std::size_t fan_in;  ///< inputs of one output, for initialisation
};

/// A specification bound to an input shape and a number type: constants and static functions, without state.
template <class Layer, class T = typename Layer::value_type>
concept layer =
    std::floating_point<T> &&
    requires(const execution_context& context, const T* parameters, T* statistics,
             typename Layer::memory& memory, batch_view<const T, Layer::input, kernels::lanes<T>> in,
             batch_view<T, Layer::output, kernels::lanes<T>> out,
             batch_view<const T, Layer::output, kernels::lanes<T>> out_gradient,
             batch_view<T, Layer::input, kernels::lanes<T>> in_gradient, T* parameter_gradients,
             std::vector<parameter>& list) {
        // Costs, as constants: learnable parameters, running statistics, multiply-adds of one sample.
        { Layer::parameters + Layer::statistics + Layer::multiply_adds } -> std::convertible_to<std::size_t>;
        { Layer::multiply_adds_on_pixels } -> std::convertible_to<std::size_t>;
        // Whether it can write over its input. `backward` then must not need the input.
        { Layer::in_place } -> std::convertible_to<bool>;
        // Whether `backward` needs the output as the layer left it.
        { Layer::keeps_output } -> std::convertible_to<bool>;
        // Whether it processes a batch part by part (see part_layer).
        { Layer::by_parts } -> std::convertible_to<bool>;
        // Whether it must see all parts of the batch before it computes the first.
        { Layer::observes } -> std::convertible_to<bool>;
        // Appends the layer's arrays, with offsets from its first.
        Layer::describe(std::string{}, list);
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
concept part_layer = layer<Layer> && Layer::by_parts &&
                     (!Layer::observes || observing_layer<Layer>)&&requires(
                         const execution_context& context, const T* parameters, T* statistics,
                         typename Layer::memory& memory, std::size_t samples, T* parameter_gradients) {
                         Layer::begin_forward(context, statistics, memory, samples);
                         Layer::begin_backward(context, parameters, memory, samples);
                         Layer::end_backward(memory, parameter_gradients);
                     };

/// A layer that a list can hold.
template <class Layer>
concept listed_layer = part_layer<Layer> || (layer<Layer> && !Layer::by_parts && !Layer::observes);

/// The memory of a layer that needs none.
struct no_memory {
    void resize(std::size_t) {}
};

/// The defaults of a layer; its constants are what `Spec::costs` returns. `Spec::layer<T, Input>` derives
/// from it.
template <class T, shape Input, class Spec>
struct layer_base {
private:
    static constexpr layer_costs own = Spec::costs(Input);

public:
    using value_type = T;
    using memory = no_memory;
    static constexpr shape input = Input, output = own.output;
    static constexpr std::size_t parameters = own.parameters, statistics = own.statistics;
    static constexpr std::size_t multiply_adds = own.multiply_adds,
                                 multiply_adds_on_pixels = own.multiply_adds_on_pixels;
    static constexpr std::size_t inner_activations = own.inner_activations;
    static constexpr bool in_place = own.in_place, keeps_output = own.keeps_output;
    static constexpr bool by_parts = false, observes = false;

    static void describe(const std::string&, std::vector<parameter>&) {}
    static void prepare(const execution_context&, const T*, const T*, auto&) {}
    /// Computes what inference does.
    static void forward(const execution_context& context, const T* values, T* running, auto& memory,
                        input_view<T, Input> in, output_view<T, output> out) {
        Spec::template layer<T, Input>::infer(context, values, running, memory, in, out);
    }
    static void begin_forward(const execution_context&, T*, auto&, std::size_t) {}
    static void begin_backward(const execution_context&, const T*, auto&, std::size_t) {}
    static void end_backward(auto&, T*) {}
};

/// A layer without parameters that computes each lane block by itself. `Spec::layer<T, Input>` has only
///
///     static void forward_block(const T* in, T* out);
///     static void backward_block(const T* in, const T* out, const T* out_gradient, T* in_gradient);
template <class T, shape Input, class Spec>
struct lane_block_layer : layer_base<T, Input, Spec> {
    using layer_base<T, Input, Spec>::output;
    static constexpr bool by_parts = true;

    static void infer(const execution_context& context, const T*, const T*, no_memory&,
                      input_view<T, Input> in, output_view<T, output> out) {
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            Spec::template layer<T, Input>::forward_block(in.lane_block(b), out.lane_block(b));
        });
    }
    static void backward(const execution_context& context, const T*, no_memory&, input_view<T, Input> in,
                         input_view<T, output> out, input_view<T, output> out_gradient,
                         output_view<T, Input> in_gradient, T*) {
        if (in_gradient.data() == nullptr)
            return;
        context.threads.for_each(in.lane_blocks(), [&](std::size_t b) {
            Spec::template layer<T, Input>::backward_block(
                in.lane_block(b), out.lane_block(b), out_gradient.lane_block(b), in_gradient.lane_block(b));
        });
    }
};

// Functions on the way to a layer's output shape (detail::…_output) reject what does not fit, not the layer
// itself: Clang takes no constants from a class with a failed assertion, and would bury the sentence under
// further errors.

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

} // namespace detail

/// Appends the array "prefix.name" to the layer's arrays. `flattened` is the input of a fully connected
/// layer, for its weights. Not inlined, to save compile time.
[[gnu::cold, gnu::noinline]] inline void
describe_array(std::vector<parameter>& list, const std::string& prefix, const char* name, parameter_role role,
               std::initializer_list<std::size_t> extents, std::size_t offset, std::size_t fan_in = 1,
               const shape& flattened = {0, 0, 0}) {
    std::string path(prefix); // appending compiles less than adding
    path.append(".", 1).append(name);
    parameter p{{std::move(path), extents, {}, offset, 0}, role, fan_in};
    p.size = detail::product_of(p.extents);
    if (flattened.size() > 0)
        p.flattened = {flattened.channels, flattened.rows, flattened.columns};
    list.push_back(std::move(p));
}

}} // namespace tactnet
