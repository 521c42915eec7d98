#pragma once

#include <tactnet/layers/sequence.hpp>

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

namespace tactnet::inline TACTNET_ARCH {

/// A list of layer specifications bound to an input shape. As a type it is a description: what it costs are
/// constants. As an object it holds parameters and running statistics on the heap, for training and
/// inference.
///
/// Input: samples of `Input`, by convention 8-bit counts 0 … 255 minus a mean image. Output: logits (or what
/// the last layer gives). T is the number type; gradients are checked in double.
template <class T, shape Input, class... Specs>
class basic_network {
    using layers = typename sequence<Specs...>::template layer<T, Input>;

public:
    using value_type = T;
    template <class Other>
    using with_value_type = basic_network<Other, Input, Specs...>;

    static constexpr shape input_shape = Input;
    static constexpr shape output_shape = layers::output;
    static constexpr std::size_t outputs = output_shape.size();
    /// Learnable parameters: weights, biases, scales and shifts.
    static constexpr std::size_t parameters = layers::parameters;
    /// Running means and variances of batch norms.
    static constexpr std::size_t statistics = layers::statistics;
    /// Multiply-adds of one sample in convolutions and dense layers, biases apart: all taps …
    static constexpr std::size_t multiply_adds = layers::multiply_adds;
    /// … and only those that fall on real pixels.
    static constexpr std::size_t multiply_adds_on_pixels = layers::multiply_adds_on_pixels;
    /// The most bytes of activations alive at once while one sample passes layer by layer, input and output
    /// included.
    static constexpr std::size_t activation_bytes =
        (Input.size() + layers::inner_activations + outputs) * sizeof(T);
    /// Bytes of all parameters and statistics.
    static constexpr std::size_t parameter_bytes = (parameters + statistics) * sizeof(T);

    /// Batches to fill and to read: samples interleaved by `lanes<T>` (see tensor/batch.hpp).
    using input_batch = batch<T, input_shape, lanes<T>>;
    using output_batch = batch<T, output_shape, lanes<T>>;
    using const_input = typename input_batch::const_view_type;
    using const_output = typename output_batch::const_view_type;
    using input_type = typename input_batch::view_type;
    using output_type = typename output_batch::view_type;

    /// What a batch needs on its way; one for each thread that calls a network.
    class workspace {
    public:
        /// Makes room for that many samples. Not needed before `infer` or `forward` with as many or fewer:
        /// they call it.
        void resize(std::size_t samples) {
            if (samples == memory_.samples)
                return;
            memory_.resize(samples);
        }

    private:
        friend basic_network;
        typename layers::memory memory_;
    };

    /// All zero but for scales and running variances, which are one. See initialise() in training.
    basic_network() : values_(padded_size<T>(parameters)), statistics_(padded_size<T>(statistics)) {
        for_each_parameter([](const parameter& p, std::span<T> values) {
            if (p.what == role::scale || p.what == role::running_variance)
                std::fill(values.begin(), values.end(), T{1});
        });
    }

    /// What batch norms add to a variance.
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
    /// visit(parameter, std::span<T>) for each array.
    template <class Visit>
    void for_each_parameter(Visit&& visit) {
        for (const parameter& p : describe())
            visit(p, std::span<T>((learnable(p.what) ? values_ : statistics_).data() + p.offset, p.size));
    }
    template <class Visit>
    void for_each_parameter(Visit&& visit) const {
        for (const parameter& p : describe())
            visit(p,
                  std::span<const T>((learnable(p.what) ? values_ : statistics_).data() + p.offset, p.size));
    }

    /// Readies a workspace for this network's present parameters. Call it again whenever they change.
    void prepare(thread_pool& threads, workspace& space) const {
        layers::prepare(make_pass(threads), values_.data(), statistics_.data(), space.memory_);
    }
    /// Logits of a batch, with running statistics. The workspace must be prepared. A sample's result has the
    /// same bits whatever the batch and the threads.
    void infer(thread_pool& threads, workspace& space, const_input in, output_type out) const {
        space.resize(in.samples());
        layers::infer(make_pass(threads), values_.data(), statistics_.data(), space.memory_, in, out);
    }
    /// Logits of a batch in training: moments of the batch in batch norms (which move the running ones),
    /// dropout.
    void forward(thread_pool& threads, workspace& space, const_input in, output_type out,
                 std::uint64_t seed = 0, std::uint32_t step = 0) {
        space.resize(in.samples());
        layers::forward(make_pass(threads, seed, step), values_.data(), statistics_.data(), space.memory_, in,
                        out);
    }
    /// Gradients of the learnable parameters (as many as `learnable_values`, or without the zeros behind),
    /// after `forward` with the same arguments; `in_gradient` may be a null view.
    void backward(thread_pool& threads, workspace& space, const_input in, const_output out,
                  const_output out_gradient, input_type in_gradient, std::span<T> gradients,
                  std::uint64_t seed = 0, std::uint32_t step = 0) const {
        layers::backward(make_pass(threads, seed, step), values_.data(), space.memory_, in, out, out_gradient,
                         in_gradient, gradients.data());
    }

private:
    [[nodiscard]] pass make_pass(thread_pool& threads, std::uint64_t seed = 0, std::uint32_t step = 0) const {
        return {.threads = threads, .epsilon = epsilon, .momentum = momentum, .seed = seed, .step = step};
    }

    aligned_vector<T> values_, statistics_;
};

/// A network in single precision: what is trained, saved and deployed.
template <shape Input, class... Specs>
using network = basic_network<float, Input, Specs...>;

} // namespace tactnet
