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
        std::vector<float> folded(tactnet::deployment_plan<Network>::folded);
        tactnet::deployment_plan<Network>::fold(source, folded.data());
        d.add(tactnet::deployment_plan<Network>{}, folded.data(), 0);
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
    template <class L, std::size_t C, std::size_t N, std::size_t P, bool R, bool A, std::size_t S>
    std::size_t add(tactnet::convolution_step<L, C, N, P, R, A, S>, const float* folded, std::size_t from) {
        using step = tactnet::convolution_step<L, C, N, P, R, A, S>;
        using layer = typename step::layer;
        const std::size_t to = A ? other_term_ : new_map(layer::output);
        operations_.push_back({.what = operation::kind::convolution,
                               .input = from,
                               .output = to,
                               .window = layer::window,
                               .from = layer::input,
                               .to = layer::output,
                               .rectified = R,
                               .adds = A,
                               .weights = {folded, folded + layer::weights},
                               .bias = {folded + layer::weights, folded + layer::parameters}});
        if constexpr (P != tactnet::no_layer)
            return add_pool<typename L::template at<P>>(to);
        else
            return to;
    }
    template <class L, std::size_t I, std::size_t S>
    std::size_t add(tactnet::pool_step<L, I, S>, const float*, std::size_t from) {
        return add_pool<typename L::template at<I>>(from);
    }
    template <class L, std::size_t I, std::size_t S>
    std::size_t add(tactnet::dense_step<L, I, S>, const float* folded, std::size_t from) {
        using layer = typename L::template at<I>;
        const std::size_t to = new_map(layer::output);
        operations_.push_back({.what = operation::kind::dense,
                               .input = from,
                               .output = to,
                               .from = layer::input,
                               .to = layer::output,
                               .weights = {folded, folded + layer::weights},
                               .bias = {folded + layer::weights, folded + layer::parameters}});
        return to;
    }
    template <class L, std::size_t I, class Main, class Skip, std::size_t S>
    std::size_t add(tactnet::step_at_layer<L, I, tactnet::residual_step<Main, Skip, S>>, const float* folded,
                    std::size_t from) {
        std::size_t term = from;
        if constexpr (!std::is_void_v<Skip>)
            term = add(Skip{}, folded + Main::folded, from);
        other_term_ = term;
        return add(Main{}, folded, from);
    }
    template <class Pool>
    std::size_t add_pool(std::size_t from) {
        const std::size_t to = new_map(Pool::output);
        operations_.push_back({.what = operation::kind::pool,
                               .input = from,
                               .output = to,
                               .window = Pool::window,
                               .from = Pool::input,
                               .to = Pool::output});
        return to;
    }

    std::vector<operation> operations_;
    std::vector<tactnet::shape> maps_;
    std::size_t other_term_ = 0;
};

} // namespace benchmark
