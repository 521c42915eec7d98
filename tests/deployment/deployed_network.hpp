#pragma once

// What the tests of deployed networks share: networks full of numbers, frames, and the network in the
// reference, with the bound of its errors (support/layers/deployed_reference.hpp).

#include <tactnet/deployment.hpp>
#include <tactnet/networks/network.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <ostream>
#include <span>
#include <stdexcept>
#include <support/layers/deployed_reference.hpp>
#include <support/layers/reference_of.hpp>
#include <type_traits>
#include <vector>

namespace support {

/// Numbers spread evenly over [low, high), the same everywhere (Knuth's 64-bit generator).
class numbers {
public:
    explicit numbers(std::uint64_t seed) : state_(seed * 2 + 1) { next(0, 1), next(0, 1); }
    float next(float low, float high) {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return low + (high - low) * static_cast<float>(state_ >> 40) * 0x1p-24f;
    }

private:
    std::uint64_t state_;
};

/// No parameter is left at a value that would hide a mistake: no zero, no one, norms of both signs.
template <class Network>
void fill(Network& net, std::uint64_t seed) {
    numbers draw(seed);
    net.for_each_parameter([&](const tactnet::parameter& p, auto values) {
        using tactnet::parameter_role;
        const float spread =
            p.role == parameter_role::weight ? std::sqrt(6.0f / static_cast<float>(p.fan_in)) : 0.5f;
        for (float& value : values) {
            value = draw.next(-spread, spread);
            if (p.role == parameter_role::running_variance)
                value = 0.3f + 2 * std::abs(value);
            if (p.role == parameter_role::scale)
                value += value < 0 ? -0.7f : 0.7f;
        }
    });
}

/// Counts of a frame as a sensor may give them: most of it untouched.
inline std::vector<std::uint8_t> make_frame(std::size_t size, std::uint64_t seed) {
    numbers draw(seed + 1000);
    std::vector<std::uint8_t> counts(size);
    for (std::uint8_t& c : counts)
        c = static_cast<std::uint8_t>(std::max(0.0f, draw.next(-100, 256)));
    return counts;
}

/// The tiles of all convolutions of a step, in the order of their parameters. The sum of a residual block may
/// be a convolution as well, which has none.
template <class Step>
void append_tiled(std::vector<tile_size>& list) {
    const auto append = [&]<class Argument, class Own = Step>(const Argument& argument) {
        if constexpr (tactnet::detail::is_inner_step<Argument>)
            append_tiled<typename Argument::step>(list);
        else if constexpr (std::is_same_v<Argument, tactnet::kernels::frame_convolution>) {
            const auto& w = argument.window;
            if (!argument.accumulates || argument.groups < argument.filters ||
                w.kernel != tactnet::extent2d(1))
                list.push_back({Own::method::tile.rows, Own::method::tile.columns});
        }
    };
    tactnet::step_description<Step>::visit(
        [&](const char*, const char*, const auto&... arguments) { (append(arguments), ...); });
}
template <class Network>
described_network describe() {
    constexpr tactnet::shape input = Network::input_shape;
    described_network network{
        reference_of<typename Network::specification>::on({input.channels, input.rows, input.columns})};
    append_tiled<typename tactnet::lowered_network<Network>::step>(network.tiles);
    if (network.tiles.size() != network.layers->convolutions)
        throw std::logic_error("describe: the steps have other convolutions than the layers");
    return network;
}

template <class Network>
network_parameters parameters_of(const Network& net) {
    const auto values = net.learnable_values(), running = net.running_statistics();
    return {{values.begin(), values.end()}, {running.begin(), running.end()}, net.epsilon};
}

/// The largest error of an output ÷ its bound, at most 1 if all is well, and ÷ its deviation. Infinite for
/// what is not a number, and for a wrong count of outputs.
struct error_shares {
    double of_bound = 0, of_deviation = 0;

    void add(const error_shares& other) {
        of_bound = std::max(of_bound, other.of_bound);
        of_deviation = std::max(of_deviation, other.of_deviation);
    }
    /// Errors stay well below their deviation, which takes every partial sum for as large as all its terms
    /// together.
    [[nodiscard]] bool good() const { return of_bound <= 1 && of_deviation <= 1; }
    explicit operator bool() const { return good(); }
};
inline std::ostream& operator<<(std::ostream& to, const error_shares& s) {
    return to << "largest error " << s.of_bound << " of its bound, " << s.of_deviation << " of its deviation";
}

inline error_shares shares_of(std::span<const float> found, const sample& expected) {
    if (found.size() != expected.size())
        return {INFINITY, INFINITY};
    error_shares worst;
    for (std::size_t o = 0; o < found.size(); ++o) {
        const double error = std::abs(static_cast<double>(found[o]) - expected[o].value);
        if (!std::isfinite(error))
            return {INFINITY, INFINITY};
        if (error > 0)
            worst.add({error / expected[o].error, error / expected[o].deviation});
    }
    return worst;
}

/// Deploys a network of that kind, full of numbers, and gives the largest errors over some frames.
template <class Network>
error_shares errors_of(std::uint64_t seed, std::size_t frames, float scale = 1.0f / 64) {
    Network net;
    fill(net, seed);
    constexpr std::size_t size = Network::input_shape.size();
    std::vector<float> mean(size);
    numbers draw(seed + 7);
    for (float& m : mean)
        m = draw.next(0, 60);
    const auto fast = tactnet::deploy(net, std::span<const float, size>(mean), scale);
    const described_network layers = describe<Network>();
    error_shares worst;
    for (std::size_t i = 0; i < frames; ++i) {
        const std::vector<std::uint8_t> counts = make_frame(size, seed * 100 + i);
        const std::vector<float> exact(counts.begin(), counts.end());
        std::vector<float> out(Network::outputs, NAN);
        const auto status =
            fast.infer(tactnet::tensor_view<const std::uint8_t, Network::input_shape>(counts.data()),
                       std::span<float, Network::outputs>(out));
        if (status != tactnet::frame_status::ok)
            return {INFINITY, INFINITY};
        const sample expected =
            bounded_outputs(layers, parameters_of(net), bounded_input(exact, mean, scale));
        worst.add(shares_of(out, expected));
    }
    return worst;
}

} // namespace support
