#pragma once

#include <tactnet/kernels/simd/vector.hpp>
#include <tactnet/operators/activations/layer.hpp>
#include <tactnet/operators/sequence/layer.hpp>
#include <tactnet/tensor/batch.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace tactnet { inline namespace TACTNET_ARCH {

class thread_pool;

namespace detail {

/// How a network computes batches (networks/batch_passes.hpp).
template <class Network, class = void>
struct batch_passes {
    static_assert(sizeof(Network) == 0,
                  "network: to train or to compute batches, include tactnet/training.hpp");
};

/// Removes the softmax from the end of a list, or of a list at its end. `Kept` are the layers so far.
template <class Kept, class... Specs>
struct split_softmax;
template <class... Kept>
struct split_softmax<sequence<Kept...>> {
    using logits = sequence<Kept...>;
    static constexpr bool found = false;
};
template <class... Kept, class Spec, class... Rest>
struct split_softmax<sequence<Kept...>, Spec, Rest...> : split_softmax<sequence<Kept..., Spec>, Rest...> {};
template <class... Kept>
struct split_softmax<sequence<Kept...>, softmax> {
    using logits = sequence<Kept...>;
    static constexpr bool found = true;
};
template <class... Kept, class... Inner>
struct split_softmax<sequence<Kept...>, sequence<Inner...>> {
    using inner = split_softmax<sequence<>, tactnet::without_name<Inner>...>;
    using logits = sequence<Kept..., typename inner::logits>;
    static constexpr bool found = inner::found;
};

/// Whether the first layer of a list has `needs_counts`.
template <class... Specs>
inline constexpr bool begins_with_counts = false;
template <class First, class... Rest>
inline constexpr bool begins_with_counts<First, Rest...> = [] {
    if constexpr (requires { First::needs_counts; })
        return First::needs_counts;
    else
        return false;
}();
template <class... Inner, class... Rest>
inline constexpr bool begins_with_counts<sequence<Inner...>, Rest...> =
    begins_with_counts<tactnet::without_name<Inner>...>;

} // namespace detail

/// A list of layer specifications bound to an input shape. The type describes the network: its costs are
/// constants. An object holds parameters and running statistics on the heap, for training and inference.
///
/// The input are samples of `Input`, by convention 8-bit counts 0 … 255 minus a mean image. Logits are the
/// output before a softmax at the end, or the output if there is none. Losses and metrics use logits, so that
/// no softmax is taken twice. T is the number type; tests check gradients in double.
template <class T, shape Input, class... Specs>
class basic_network {
    using split = detail::split_softmax<sequence<>, without_name<Specs>...>;
    using passes = detail::batch_passes<basic_network>;
    friend passes;

public:
    /// The list as written, and bound to the input, for deployment.
    using specification = sequence<Specs...>;
    using logit_specification = typename split::logits; ///< without a softmax at the end
    using layers = typename specification::template layer<T, Input>;
    using value_type = T;
    template <class Other>
    using with_value_type = basic_network<Other, Input, Specs...>;

    static constexpr shape input_shape = Input;
    static constexpr shape output_shape = layers::output;
    /// Whether outputs are probabilities. The softmax has no parameters.
    static constexpr bool ends_in_softmax = split::found;
    static constexpr std::size_t outputs = output_shape.size();
    /// Whether the first layer needs counts, scaled or not, without a mean subtracted.
    static constexpr bool needs_counts = detail::begins_with_counts<without_name<Specs>...>;
    /// Learnable parameters: weights, biases, scales and shifts.
    static constexpr std::size_t parameters = layers::parameters;
    /// Running means and variances of batch norms.
    static constexpr std::size_t statistics = layers::statistics;
    /// Multiply-adds of one sample in convolutions and dense layers, biases apart: all taps …
    static constexpr std::size_t multiply_adds = layers::multiply_adds;
    /// … and only those that fall on real pixels.
    static constexpr std::size_t multiply_adds_on_pixels = layers::multiply_adds_on_pixels;
    /// Peak activation memory of one sample in bytes, layer by layer, input and output included.
    static constexpr std::size_t activation_bytes =
        (Input.size() + layers::inner_activations + outputs) * sizeof(T);
    /// Bytes of all parameters and statistics.
    static constexpr std::size_t parameter_bytes = (parameters + statistics) * sizeof(T);

    /// Batches to fill and to read: samples interleaved by `lanes<T>` (see tensor/batch.hpp).
    using input_batch = batch<T, input_shape, kernels::lanes<T>>;
    using output_batch = batch<T, output_shape, kernels::lanes<T>>;
    using const_input = typename input_batch::const_view_type;
    using const_output = typename output_batch::const_view_type;
    using input_type = typename input_batch::view_type;
    using output_type = typename output_batch::view_type;

    /// Memory for a batch; one for each thread that calls a network.
    class workspace {
    public:
        /// Makes room for a number of samples. `infer`, `logits` and `forward` call it.
        void resize(std::size_t samples) {
            if (samples != memory_.samples)
                memory_.resize(samples);
        }

    private:
        friend passes;
        typename passes::memory memory_;
    };

    /// All parameters have their initial_value: zero, except scales and running variances, which are one, and
    /// slopes. See initialise() in training.
    basic_network()
        : values_(kernels::padded_size<T>(parameters)), statistics_(kernels::padded_size<T>(statistics)) {
        for_each_parameter([](const parameter& p, std::span<T> values) {
            std::fill(values.begin(), values.end(), static_cast<T>(initial_value(p.role)));
        });
    }

    /// Added to the variance by norms.
    double epsilon = 1e-5;
    /// Share of each training batch in the running statistics of batch norms.
    double momentum = 0.1;

    /// All learnable parameters, then zeros up to a whole vector.
    [[nodiscard]] std::span<T> learnable_values() { return values_; }
    [[nodiscard]] std::span<const T> learnable_values() const { return values_; }
    /// All running statistics, then zeros up to a whole vector.
    [[nodiscard]] std::span<T> running_statistics() { return statistics_; }
    [[nodiscard]] std::span<const T> running_statistics() const { return statistics_; }

    /// All arrays in order, with PyTorch's names.
    [[nodiscard]] static std::vector<parameter> describe() {
        std::vector<parameter> list;
        layers::describe("", list);
        return list;
    }
    /// Calls visit(parameter, std::span<T>) for each array.
    template <class Visit>
    void for_each_parameter(Visit&& visit) {
        for (const parameter& p : describe())
            visit(p, std::span<T>((learnable(p.role) ? values_ : statistics_).data() + p.offset, p.size));
    }
    template <class Visit>
    void for_each_parameter(Visit&& visit) const {
        for (const parameter& p : describe())
            visit(p,
                  std::span<const T>((learnable(p.role) ? values_ : statistics_).data() + p.offset, p.size));
    }

    /// Prepares a workspace for the present parameters. Call it again whenever they change.
    void prepare(thread_pool& threads, workspace& space) const { passes::prepare(*this, threads, space); }
    /// Computes the outputs of a batch, with running statistics. The workspace must be prepared. The result
    /// of a sample is bit-identical in any batch and on any number of threads. Batches of any size are
    /// computed in parts, so that the workspace stays small.
    void infer(const_input in, output_type out, thread_pool& threads, workspace& space) const {
        passes::infer(*this, in, out, threads, space);
    }
    /// As `infer`, before a last softmax.
    void logits(const_input in, output_type out, thread_pool& threads, workspace& space) const {
        passes::logits(*this, in, out, threads, space);
    }
    /// Computes the logits of a batch in training: with dropout, and with the moments of the batch in batch
    /// norms, which update the running ones.
    void forward(const_input in, output_type out, thread_pool& threads, workspace& space,
                 std::uint64_t seed = 0, std::uint32_t step = 0) {
        passes::forward(*this, in, out, threads, space, seed, step);
    }
    /// Computes the gradients of the learnable parameters (as many as `learnable_values`, or without the
    /// trailing zeros) from the gradients of the logits, after `forward` with the same arguments.
    /// `in_gradient` may be a null view.
    void backward(const_input in, const_output out, const_output out_gradient, input_type in_gradient,
                  std::span<T> gradients, thread_pool& threads, workspace& space, std::uint64_t seed = 0,
                  std::uint32_t step = 0) const {
        passes::backward(*this, in, out, out_gradient, in_gradient, gradients, threads, space, seed, step);
    }

private:
    aligned_vector<T> values_, statistics_;
};

/// A network in single precision: what is trained, saved and deployed.
template <shape Input, class... Specs>
using network = basic_network<float, Input, Specs...>;

}} // namespace tactnet
