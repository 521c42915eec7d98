#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/layers/costs.hpp>
#include <tactnet/runtime/random.hpp>
#include <tactnet/runtime/thread_pool.hpp>
#include <tactnet/tensor/batch.hpp>
#include <tactnet/tensor/named_array.hpp>

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

// What a layer is. A list of layers holds shape-free specifications (`conv2d<8, 5>`); bound to an input shape
// and a number type, a specification becomes a layer: constants and static functions, without state.
// Parameters lie in one flat array of the network, what a batch leaves behind for the way back lies in the
// layer's `memory`.

namespace tactnet {
inline namespace TACTNET_ARCH {

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

/// Groups that hold so many samples.
template <class T>
[[nodiscard]] constexpr std::size_t groups_of(std::size_t samples) {
    return kernels::padded_size<T>(samples) / kernels::lanes<T>;
}

/// What a network knows and a layer asks for while a batch passes.
struct execution_context {
    thread_pool& threads;
    double epsilon = 1e-5;       ///< added to the variance by batch norms
    double momentum = 0.1;       ///< share of a batch in the running statistics of batch norms
    std::uint64_t seed = 0;      ///< for dropout
    std::uint32_t step = 0;      ///< batches so far, for dropout
    std::uint32_t depth = 0;     ///< tells the layers of a list apart, for dropout
    std::size_t first_group = 0; ///< groups of the batch before this part of it
};

/// What an array of a network is for.
enum class parameter_role { weight, bias, scale, shift, running_mean, running_variance };

/// Learnable by gradient descent; running statistics are not.
[[nodiscard]] constexpr bool learnable(parameter_role r) {
    return r != parameter_role::running_mean && r != parameter_role::running_variance;
}

/// One array of a network. Its offset counts in the learnable parameters of the network, or in its
/// statistics.
struct parameter : named_array {
    parameter_role what; ///< decides how initialisation and weight decay treat it
    std::size_t fan_in;  ///< inputs of one output, for initialisation
};

/// A specification bound to an input shape and a number type: constants and static functions, without state.
template <class Layer, class T = typename Layer::value_type>
concept layer = std::floating_point<T> &&
    requires(const execution_context& p, const T* parameters, T* statistics, typename Layer::memory& memory,
             batch_view<const T, Layer::input, kernels::lanes<T>> in,
             batch_view<T, Layer::output, kernels::lanes<T>> out,
             batch_view<const T, Layer::output, kernels::lanes<T>> out_gradient,
             batch_view<T, Layer::input, kernels::lanes<T>> in_gradient, T* parameter_gradients,
             std::vector<parameter>& list) {
    // Costs, as constants: learnable parameters, running statistics, multiply-adds of one sample.
    { Layer::parameters + Layer::statistics + Layer::multiply_adds } -> std::convertible_to<std::size_t>;
    { Layer::multiply_adds_on_pixels } -> std::convertible_to<std::size_t>;
    // Whether the output may take the input's place: then `backward` must not need the input.
    { Layer::in_place } -> std::convertible_to<bool>;
    // Whether `backward` needs the output as it was left.
    { Layer::keeps_output } -> std::convertible_to<bool>;
    // Whether it takes a batch by parts (see part_layer).
    { Layer::by_parts } -> std::convertible_to<bool>;
    // Whether it must see all parts before the first of them can pass.
    { Layer::observes } -> std::convertible_to<bool>;
    // Appends the layer's arrays, offsets counted from its first.
    Layer::describe(std::string{}, list);
    memory.resize(std::size_t{});
    // Once after the parameters changed; `infer` uses the running statistics, `forward` those of the batch.
    Layer::prepare(p, parameters, statistics, memory);
    Layer::infer(p, parameters, statistics, memory, in, out);
    Layer::forward(p, parameters, statistics, memory, in, out);
    // Sets the input's gradient unless no one asks for it (a null view), and, if it takes no parts, those of
    // the parameters.
    Layer::backward(p, parameters, memory, in, out_gradient, out_gradient, in_gradient, parameter_gradients);
};

/// A layer that must see the whole batch before any of it can pass.
template <class Layer, class T = typename Layer::value_type>
concept observing_layer = requires(const execution_context& p, typename Layer::memory& memory,
                                   batch_view<const T, Layer::input, kernels::lanes<T>> in,
                                   batch_view<const T, Layer::output, kernels::lanes<T>> out,
                                   batch_view<const T, Layer::output, kernels::lanes<T>> out_gradient) {
    Layer::observe_forward(p, memory, in);
    Layer::observe_backward(p, memory, in, out, out_gradient);
};

/// A layer that takes a batch by parts: what it gives for a part goes to the next layer while it is in the
/// caches. Parts are whole groups, at most as many as there are threads, and come in order; the views are of
/// the part, `execution_context::first_group` tells where it begins, the memory is that of the whole batch.
/// For one batch are called, in this order,
///   observe_forward(part) …  begin_forward  forward(part) …
///   observe_backward(part) … begin_backward backward(part) … end_backward
/// and the parameters' gradients are set by the last.
template <class Layer, class T = typename Layer::value_type>
concept part_layer = layer<Layer> && Layer::by_parts &&
    (!Layer::observes || observing_layer<Layer>)&&requires(const execution_context& p, const T* parameters,
                                                           T* statistics, typename Layer::memory& memory,
                                                           std::size_t samples, T* parameter_gradients) {
    Layer::begin_forward(p, statistics, memory, samples);
    Layer::begin_backward(p, parameters, memory, samples);
    Layer::end_backward(memory, parameter_gradients);
};

/// What a list can hold.
template <class Layer>
concept listed_layer = part_layer<Layer> ||(layer<Layer> && !Layer::by_parts && !Layer::observes);

/// The memory of a layer that needs none.
struct no_memory {
    void resize(std::size_t) {}
};

/// What most layers are, so that each says only what differs. The constants are what the specification says
/// of its costs.
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
    static void begin_forward(const execution_context&, T*, auto&, std::size_t) {}
    static void begin_backward(const execution_context&, const T*, auto&, std::size_t) {}
    static void end_backward(auto&, T*) {}
};

// What does not fit is refused by a function on the way to a layer's output shape (detail::…_output), not in
// the layer itself: of a class with a failed assertion Clang takes no constant, and the sentence would drown
// in what follows.

/// How PyTorch names what lies in something named: with a point between, unless there is no name.
[[nodiscard]] [[gnu::cold, gnu::noinline]] inline std::string joined_name(const std::string& outer,
                                                                          const std::string& inner) {
    return outer.empty() || inner.empty() ? outer + inner : outer + "." + inner;
}

/// Appends the array "prefix.name" to those that the layer has described so far. `flattened` is the input of
/// a fully connected layer, for its weights. Not inlined, to save compile time.
[[gnu::cold, gnu::noinline]] inline void
describe_array(std::vector<parameter>& list, const std::string& prefix, const char* name, parameter_role what,
               std::initializer_list<std::size_t> extents, std::size_t offset, std::size_t fan_in = 1,
               const shape& flattened = {0, 0, 0}) {
    parameter p{{prefix + "." + name, extents, {}, offset, 0}, what, fan_in};
    p.size = product_of(p.extents);
    if (flattened.size() > 0)
        p.flattened = {flattened.channels, flattened.rows, flattened.columns};
    list.push_back(std::move(p));
}

} // namespace TACTNET_ARCH
} // namespace tactnet
