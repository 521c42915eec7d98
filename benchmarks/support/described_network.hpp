#pragma once

#include <tactnet/deployment.hpp>

#include <cstddef>
#include <utility>
#include <vector>

// A network as other libraries take it: operations on numbered maps, batch norms folded. Made from the steps
// of a deployed network, so that all compute the same function.

namespace benchmark {

struct operation {
    enum class kind { convolution, pool, average, dense, relu, concatenation };

    kind what;
    std::size_t input, output;                ///< numbers of maps; 0 is the frame
    std::vector<std::size_t> inputs{};        ///< of concatenations, in order
    tactnet::sliding_window window{{}, 1, 1}; ///< of convolutions and pools
    tactnet::shape from{}, to{};              ///< sizes of the maps
    bool relu = false;
    bool accumulates = false;             ///< to the map `output`, which holds the other term
    std::vector<float> weights{}, bias{}; ///< [output][channel][row][column]
};

/// From [output][channel][row][column] to [output][row][column][channel].
template <class Number>
[[nodiscard]] std::vector<Number> channels_last(const operation& o, const std::vector<Number>& weights) {
    std::vector<Number> to(weights.size());
    const std::size_t channels = o.from.channels, taps = weights.size() / (o.bias.size() * channels);
    for (std::size_t i = 0; i < to.size(); ++i)
        to[i] = weights[(i / (taps * channels) * channels + i % channels) * taps + i / channels % taps];
    return to;
}

class described_network {
public:
    template <class Network>
    static described_network of(const Network& network) {
        const tactnet::parameter_source source{network.learnable_values().data(),
                                               network.running_statistics().data(), network.epsilon};
        using plan = tactnet::lowered_network<Network>;
        std::vector<float> folded(plan::step::folded_elements);
        plan::fold(source, folded.data());
        return of_folded<Network>(folded.data());
    }
    /// From the folded numbers of the network's steps.
    template <class Network>
    static described_network of_folded(const float* folded) {
        described_network d;
        d.maps_.push_back(Network::input_shape);
        d.add(typename tactnet::lowered_network<Network>::step{}, folded, 0);
        return d;
    }
    [[nodiscard]] const std::vector<operation>& operations() const { return operations_; }
    [[nodiscard]] const std::vector<tactnet::shape>& maps() const { return maps_; }
    /// Terms of the sum of one output, of all layers together: what roundings grow with.
    [[nodiscard]] std::size_t terms() const {
        std::size_t all = 0;
        for (const operation& o : operations_)
            all += o.bias.empty() ? 0 : o.weights.size() / o.bias.size();
        return all;
    }

private:
    std::size_t new_map(tactnet::shape s) {
        maps_.push_back(s);
        return maps_.size() - 1;
    }

    // Each returns the number of the map that holds the step's result.
    template <class... Steps>
    std::size_t add(tactnet::step_chain<Steps...>, const float* folded, std::size_t from) {
        ((from = add(Steps{}, folded, from), folded += Steps::folded_elements), ...);
        return from;
    }
    template <tactnet::kernels::frame_convolution C>
    std::size_t add(tactnet::convolution_step<tactnet::single_precision, C>, const float* folded,
                    std::size_t from) {
        static_assert(C.groups == 1, "described_network: convolutions in groups are not described");
        static_assert(!C.activation->exists || C.rectifies(),
                      "described_network: of activation functions only ReLU is described");
        using step = tactnet::convolution_step<tactnet::single_precision, C>;
        const tactnet::shape full{C.window.output_rows(), C.window.output_columns(), C.filters};
        const std::size_t to = C.accumulates ? other_term_ : new_map(full);
        operations_.push_back({.what = operation::kind::convolution,
                               .input = from,
                               .output = to,
                               .window = C.window,
                               .from = C.window.input,
                               .to = full,
                               .relu = C.rectifies(),
                               .accumulates = C.accumulates,
                               .weights = {folded, folded + step::weights},
                               .bias = {folded + step::weights, folded + step::folded_elements}});
        if constexpr (C.pool == tactnet::extent2d(1)) {
            return to;
        } else {
            tactnet::sliding_window pool{full, C.pool, C.pool};
            const auto missing = [](std::size_t outputs, std::size_t window, std::size_t size) {
                return outputs * window > size ? outputs * window - size : 0;
            };
            pool.bottom = missing(step::output.rows, C.pool.rows, full.rows);
            pool.right = missing(step::output.columns, C.pool.columns, full.columns);
            return add_pool(pool, to);
        }
    }
    template <tactnet::sliding_window Window, std::size_t Stride>
    std::size_t add(tactnet::pool_step<tactnet::single_precision, Window, Stride>, const float*,
                    std::size_t from) {
        return add_pool(Window, from);
    }
    template <tactnet::pooling_windows Windows, std::size_t Channels, std::size_t Stride>
    std::size_t add(tactnet::average_pool_step<tactnet::single_precision, Windows, Channels, Stride>,
                    const float*, std::size_t from) {
        constexpr auto rows = Windows.rows, columns = Windows.columns;
        static_assert(rows.kernel == 0 && columns.kernel == 0 && rows.size % rows.outputs == 0 &&
                          columns.size % columns.outputs == 0,
                      "described_network: average pools are described where all windows are of one size and "
                      "side by side");
        constexpr tactnet::extent2d window(rows.size / rows.outputs, columns.size / columns.outputs);
        if (window == tactnet::extent2d(1))
            return from;
        return add_pool({{rows.size, columns.size, Channels}, window, window}, from,
                        operation::kind::average);
    }
    template <tactnet::shape Map, std::size_t Stride>
    std::size_t add(tactnet::activation_step<tactnet::single_precision, tactnet::relu_function, Map, Stride>,
                    const float*, std::size_t from) {
        const std::size_t to = new_map(Map);
        operations_.push_back(
            {.what = operation::kind::relu, .input = from, .output = to, .from = Map, .to = Map});
        return to;
    }
    template <tactnet::shape Input, std::size_t InputStride, std::size_t Stride, class... Branches>
    std::size_t
    add(tactnet::concatenation_step<tactnet::single_precision, Input, InputStride, Stride, Branches...>,
        const float* folded, std::size_t from) {
        using step =
            tactnet::concatenation_step<tactnet::single_precision, Input, InputStride, Stride, Branches...>;
        std::vector<std::size_t> branches;
        ((branches.push_back(add(typename Branches::step{}, folded, from)),
          folded += Branches::step::folded_elements),
         ...);
        const std::size_t to = new_map(step::output);
        operations_.push_back({.what = operation::kind::concatenation,
                               .input = from,
                               .output = to,
                               .inputs = std::move(branches),
                               .from = Input,
                               .to = step::output});
        return to;
    }
    /// A branch that passes its input on.
    static std::size_t add(tactnet::no_step, const float*, std::size_t from) { return from; }
    template <tactnet::kernels::frame_dense D>
    std::size_t add(tactnet::dense_step<tactnet::single_precision, D>, const float* folded,
                    std::size_t from) {
        using step = tactnet::dense_step<tactnet::single_precision, D>;
        const std::size_t to = new_map(step::output);
        operations_.push_back({.what = operation::kind::dense,
                               .input = from,
                               .output = to,
                               .from = D.input,
                               .to = step::output,
                               .weights = {folded, folded + step::weights},
                               .bias = {folded + step::weights, folded + step::folded_elements}});
        return to;
    }
    template <class Main, class Skip, std::size_t Stride>
    std::size_t add(tactnet::residual_step<Main, Skip, Stride>, const float* folded, std::size_t from) {
        std::size_t term = from;
        if constexpr (!std::is_same_v<Skip, tactnet::no_step>)
            term = add(Skip{}, folded + Main::folded_elements, from);
        other_term_ = term;
        return add(Main{}, folded, from);
    }
    std::size_t add_pool(const tactnet::sliding_window& window, std::size_t from,
                         operation::kind what = operation::kind::pool) {
        const tactnet::shape to{window.output_rows(), window.output_columns(), window.input.channels};
        const std::size_t output = new_map(to);
        operations_.push_back({.what = what,
                               .input = from,
                               .output = output,
                               .window = window,
                               .from = window.input,
                               .to = to});
        return output;
    }

    std::vector<operation> operations_;
    std::vector<tactnet::shape> maps_;
    std::size_t other_term_ = 0;
};

} // namespace benchmark
