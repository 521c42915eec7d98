#pragma once

#include <tactnet/deployment.hpp>

#include <cstddef>
#include <vector>

// A network as other libraries take it: operations on numbered maps, batch norms folded. Made from the steps
// of a deployed network, so that all compute the same function.

namespace benchmark {

struct operation {
    enum class kind { convolution, pool, dense };

    kind what;
    std::size_t input, output;                ///< numbers of maps; 0 is the frame
    tactnet::sliding_window window{{}, 1, 1}; ///< of convolutions and pools
    tactnet::shape from{}, to{};              ///< sizes of the maps
    bool rectified = false;
    bool adds = false;                    ///< to the map `output`, which holds the other term
    std::vector<float> weights{}, bias{}; ///< [output][channel][row][column]
};

class described_network {
public:
    template <class Network>
    static described_network of(const Network& network) {
        described_network d;
        d.maps_.push_back(Network::input_shape);
        const tactnet::parameter_source source{network.learnable_values().data(),
                                               network.running_statistics().data(), network.epsilon};
        using plan = tactnet::deployment_plan<Network>;
        std::vector<float> folded(plan::step::folded);
        plan::fold(source, folded.data());
        d.add(typename plan::step{}, folded.data(), 0);
        return d;
    }
    [[nodiscard]] const std::vector<operation>& operations() const { return operations_; }
    [[nodiscard]] const std::vector<tactnet::shape>& maps() const { return maps_; }

private:
    std::size_t new_map(tactnet::shape s) {
        maps_.push_back(s);
        return maps_.size() - 1;
    }

    // Each returns the number of the map that holds the step's result.
    template <class... Steps>
    std::size_t add(tactnet::step_chain<Steps...>, const float* folded, std::size_t from) {
        ((from = add(Steps{}, folded, from), folded += Steps::folded), ...);
        return from;
    }
    template <tactnet::kernels::frame_convolution C>
    std::size_t add(tactnet::convolution_step<tactnet::single_precision, C>, const float* folded,
                    std::size_t from) {
        using step = tactnet::convolution_step<tactnet::single_precision, C>;
        const tactnet::shape full{C.window.output_rows(), C.window.output_columns(), C.filters};
        const std::size_t to = C.adds ? other_term_ : new_map(full);
        operations_.push_back({.what = operation::kind::convolution,
                               .input = from,
                               .output = to,
                               .window = C.window,
                               .from = C.window.input,
                               .to = full,
                               .rectified = C.rectified,
                               .adds = C.adds,
                               .weights = {folded, folded + step::weights},
                               .bias = {folded + step::weights, folded + step::folded}});
        if constexpr (C.pool == tactnet::extent(1)) {
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
                               .bias = {folded + step::weights, folded + step::folded}});
        return to;
    }
    template <class Main, class Skip, std::size_t Stride>
    std::size_t add(tactnet::residual_step<Main, Skip, Stride>, const float* folded, std::size_t from) {
        std::size_t term = from;
        if constexpr (!std::is_same_v<Skip, tactnet::no_step>)
            term = add(Skip{}, folded + Main::folded, from);
        other_term_ = term;
        return add(Main{}, folded, from);
    }
    std::size_t add_pool(const tactnet::sliding_window& window, std::size_t from) {
        const tactnet::shape to{window.output_rows(), window.output_columns(), window.input.channels};
        const std::size_t output = new_map(to);
        operations_.push_back({.what = operation::kind::pool,
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
