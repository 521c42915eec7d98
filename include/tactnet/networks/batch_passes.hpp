#pragma once

#include <tactnet/detail/arithmetic.hpp>
#include <tactnet/networks/network.hpp>
#include <tactnet/operators/training.hpp>
#include <tactnet/runtime/thread_pool.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

// How a network computes batches, in training and in inference with its trained parameters: the functions of
// basic_network. tactnet/training.hpp includes this.

namespace tactnet { inline namespace TACTNET_ARCH { namespace detail {

template <class T, shape Input, class... Specs>
struct batch_passes<basic_network<T, Input, Specs...>, void> {
    using network = basic_network<T, Input, Specs...>;
    using layers = trained_layer<with_fused_norms<typename network::logit_specification>, T, Input>;
    using memory = typename layers::memory;
    using workspace = typename network::workspace;
    using const_input = typename network::const_input;
    using const_output = typename network::const_output;
    using input_type = typename network::input_type;
    using output_type = typename network::output_type;

    static void prepare(const network& net, thread_pool& threads, workspace& space) {
        layers::prepare(context_of(net, threads), net.values_.data(), net.statistics_.data(), space.memory_);
    }
    static void infer(const network& net, const_input in, output_type out, thread_pool& threads,
                      workspace& space) {
        logits(net, in, out, threads, space);
        if constexpr (network::ends_in_softmax) {
            no_memory none;
            trained_layer<softmax, T, network::output_shape>::infer(context_of(net, threads), nullptr,
                                                                    nullptr, none, const_output(out), out);
        }
    }
    static void logits(const network& net, const_input in, output_type out, thread_pool& threads,
                       workspace& space) {
        const std::size_t blocks = in.lane_blocks(), most = threads.threads();
        const std::size_t parts = ceil_div(blocks, most);
        // Parts of nearly equal size, a largest one first, so that the workspace has room for all.
        const auto begin = [&](std::size_t part) { return ceil_div(blocks * part, parts); };
        for (std::size_t part = 0; part < parts; ++part) {
            const std::size_t first = begin(part), last = begin(part + 1);
            const std::size_t count =
                std::min(last * kernels::lanes<T>, in.samples()) - first * kernels::lanes<T>;
            space.resize(count);
            layers::infer(context_of(net, threads), net.values_.data(), net.statistics_.data(), space.memory_,
                          const_input(in.lane_block(first), count),
                          output_type(out.lane_block(first), count));
        }
    }
    static void forward(network& net, const_input in, output_type out, thread_pool& threads, workspace& space,
                        std::uint64_t seed, std::uint32_t step) {
        space.resize(in.samples());
        layers::forward(context_of(net, threads, seed, step), net.values_.data(), net.statistics_.data(),
                        space.memory_, in, out);
    }
    static void backward(const network& net, const_input in, const_output out, const_output out_gradient,
                         input_type in_gradient, std::span<T> gradients, thread_pool& threads,
                         workspace& space, std::uint64_t seed, std::uint32_t step) {
        layers::backward(context_of(net, threads, seed, step), net.values_.data(), space.memory_, in, out,
                         out_gradient, in_gradient, gradients.data());
    }

private:
    [[nodiscard]] static execution_context context_of(const network& net, thread_pool& threads,
                                                      std::uint64_t seed = 0, std::uint32_t step = 0) {
        return {
            .threads = threads, .epsilon = net.epsilon, .momentum = net.momentum, .seed = seed, .step = step};
    }
};

}}} // namespace tactnet::detail
